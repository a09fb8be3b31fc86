use crate::error::{Error, Result, within};
use crate::joints::JointRanges;

/// Measured lengths of one person's body \[m\]. Missing lengths follow from the stature.
///
/// Heights are above the floor, standing upright. If, for instance, only the hip height is
/// measured, longer legs mean a shorter trunk.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Segments {
    /// Height of the ankle joint.
    pub ankle_height: Option<f64>,
    /// Height of the knee joint.
    pub knee_height: Option<f64>,
    /// Height of the hip joint (trochanter).
    pub hip_height: Option<f64>,
    /// Height of the shoulder (acromion).
    pub shoulder_height: Option<f64>,
    /// Height of the eyes.
    pub eye_height: Option<f64>,
    /// Length of the upper arm, shoulder to elbow.
    pub upper_arm: Option<f64>,
    /// Length of the forearm, elbow to wrist.
    pub forearm: Option<f64>,
    /// Length from the wrist to the centre of the grip.
    pub grip: Option<f64>,
    /// Distance from the body's midplane to the shoulder joint.
    pub shoulder_half_width: Option<f64>,
    /// Length of the foot.
    pub foot: Option<f64>,
}

/// Lengths of the body as fractions of stature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Proportions {
    pub(crate) ankle: f64,
    pub(crate) knee: f64,
    pub(crate) hip: f64,
    pub(crate) shoulder: f64,
    pub(crate) eye: f64,
    pub(crate) upper_arm: f64,
    pub(crate) forearm: f64,
    pub(crate) grip: f64,
    pub(crate) shoulder_half_width: f64,
    pub(crate) foot: f64,
}

/// Number of segments.
pub(crate) const SEGMENTS: usize = 10;
/// Smallest and largest mass of a body \[kg\].
const MASS: [f64; 2] = [2.0, 500.0];

impl Proportions {
    /// Returns the fractions in the order of [`Segments`].
    pub(crate) fn to_array(self) -> [f64; SEGMENTS] {
        let Self { ankle, knee, hip, shoulder, eye, .. } = self;
        let Self { upper_arm, forearm, grip, shoulder_half_width, foot, .. } = self;
        [ankle, knee, hip, shoulder, eye, upper_arm, forearm, grip, shoulder_half_width, foot]
    }

    /// Creates the proportions from fractions in the order of [`Segments`].
    pub(crate) fn from_array(fractions: [f64; SEGMENTS]) -> Self {
        let [ankle, knee, hip, shoulder, eye, upper_arm, forearm, grip, shoulder_half_width, foot] =
            fractions;
        Self {
            ankle,
            knee,
            hip,
            shoulder,
            eye,
            upper_arm,
            forearm,
            grip,
            shoulder_half_width,
            foot,
        }
    }
}

/// Drillis & Contini 1966, with shoulder joint and grip from the ANSUR II means (2012).
const AVERAGE: Proportions = Proportions {
    ankle: 0.039,
    knee: 0.285,
    hip: 0.530,
    shoulder: 0.818,
    eye: 0.936,
    upper_arm: 0.186,
    forearm: 0.146,
    grip: 0.053,
    shoulder_half_width: 0.115,
    foot: 0.152,
};

/// A person: stature, mass, ranges of motion and, if measured, segment lengths.
///
/// ```
/// use ergo_map::{Person, Segments};
/// let person = Person::new(1.70)?
///     .with_segments(&Segments { upper_arm: Some(0.34), ..Default::default() })?;
/// assert_eq!(person.stature(), 1.70);
/// assert!(Person::new(170.0).is_err()); // centimetres
/// # Ok::<(), ergo_map::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Person {
    stature: f64,
    mass: f64,
    ranges: JointRanges,
    proportions: Proportions,
}

impl Person {
    /// Creates a person of average proportions.
    ///
    /// The mass is that of a body-mass index of 23 kg/m². [`Person::with_mass`] changes it.
    ///
    /// # Errors
    /// [`crate::Error::Value`] if the stature \[m\] is not from 0.5 to 2.7 m.
    pub fn new(stature: f64) -> Result<Self> {
        let stature = within("stature", stature, [0.5, 2.7], "m")?;
        Ok(Self::of_valid_stature(stature))
    }

    /// Creates a person of stature 1.58 m, the paper's shortest subject.
    pub fn short() -> Self {
        Self::of_valid_stature(1.58)
    }

    /// Creates a person of stature 1.75 m.
    pub fn average() -> Self {
        Self::of_valid_stature(1.75)
    }

    /// Creates a person of stature 1.94 m, the paper's tallest subject.
    pub fn tall() -> Self {
        Self::of_valid_stature(1.94)
    }

    fn of_valid_stature(stature: f64) -> Self {
        let mass = 23.0 * stature * stature;
        Self { stature, mass, ranges: JointRanges::default(), proportions: AVERAGE }
    }

    /// Sets the stature \[m\], and keeps proportions, ranges of motion and body-mass index.
    ///
    /// # Errors
    /// Those of [`Person::new`].
    pub(crate) fn with_stature(self, stature: f64) -> Result<Self> {
        let Self { ranges, proportions, .. } = self;
        let ratio = Self::new(stature)?.stature / self.stature;
        let mass = (self.mass * ratio * ratio).clamp(MASS[0], MASS[1]);
        Ok(Self { stature, mass, ranges, proportions })
    }

    /// Sets the mass \[kg\].
    ///
    /// # Errors
    /// [`crate::Error::Value`] if the mass is not from 2 to 500 kg.
    pub fn with_mass(self, mass: f64) -> Result<Self> {
        Ok(Self { mass: within("mass", mass, MASS, "kg")?, ..self })
    }

    /// Sets the ranges of motion.
    ///
    /// # Errors
    /// Those of [`JointRanges::validate`].
    pub fn with_ranges(self, ranges: JointRanges) -> Result<Self> {
        ranges.validate()?;
        Ok(Self { ranges, ..self })
    }

    /// Sets measured lengths. Missing lengths are average for the stature.
    ///
    /// # Errors
    /// [`Error::Value`] if no body of this stature has such a length, or if ankle, knee, hip,
    /// shoulder and eye are not in ascending order.
    pub fn with_segments(self, segments: &Segments) -> Result<Self> {
        let stature = self.stature;
        let ratio = |name, length: Option<f64>, average: f64| match length {
            None => Ok(average),
            // Half to twice the average is wide enough for everybody, and narrow enough to detect
            // wrong units.
            Some(length) => {
                let plausible = [0.5 * average * stature, (2.0 * average).min(1.0) * stature];
                within(name, length, plausible, "m").map(|length| length / stature)
            }
        };
        let proportions = Proportions {
            ankle: ratio("ankle_height", segments.ankle_height, AVERAGE.ankle)?,
            knee: ratio("knee_height", segments.knee_height, AVERAGE.knee)?,
            hip: ratio("hip_height", segments.hip_height, AVERAGE.hip)?,
            shoulder: ratio("shoulder_height", segments.shoulder_height, AVERAGE.shoulder)?,
            eye: ratio("eye_height", segments.eye_height, AVERAGE.eye)?,
            upper_arm: ratio("upper_arm", segments.upper_arm, AVERAGE.upper_arm)?,
            forearm: ratio("forearm", segments.forearm, AVERAGE.forearm)?,
            grip: ratio("grip", segments.grip, AVERAGE.grip)?,
            shoulder_half_width: ratio(
                "shoulder_half_width",
                segments.shoulder_half_width,
                AVERAGE.shoulder_half_width,
            )?,
            foot: ratio("foot", segments.foot, AVERAGE.foot)?,
        };
        let heights = [
            ("ankle_height", proportions.ankle),
            ("knee_height", proportions.knee),
            ("hip_height", proportions.hip),
            ("shoulder_height", proportions.shoulder),
            ("eye_height", proportions.eye),
            ("stature", 1.0),
        ];
        for pair in heights.windows(2) {
            if let [(lower, low), (upper, high)] = *pair
                && high - low < 0.01
            {
                let wanted = format!("lie below {upper}, {} m", high * stature);
                return Err(Error::Value { what: lower, got: low * stature, unit: "m", wanted });
            }
        }
        Ok(Self { proportions, ..self })
    }

    /// Sets the proportions. `None` for those that [`Self::with_segments`] refuses.
    pub(crate) fn with_proportions(self, proportions: Proportions) -> Option<Self> {
        // Lengths rounded to fractions may be at the end of the plausible range.
        const ROUNDING: f64 = 1e-9;
        let plausible = proportions.to_array().into_iter().zip(AVERAGE.to_array()).all(
            |(fraction, average)| {
                let (least, most) = (0.5 * average - ROUNDING, (2.0 * average).min(1.0) + ROUNDING);
                (least..=most).contains(&fraction)
            },
        );
        let Proportions { ankle, knee, hip, shoulder, eye, .. } = proportions;
        let heights = [ankle, knee, hip, shoulder, eye, 1.0];
        let follow = heights
            .windows(2)
            .all(|pair| matches!(pair, [low, high] if high - low >= 0.01 - ROUNDING));
        (plausible && follow).then_some(Self { proportions, ..self })
    }

    /// The stature \[m\].
    pub fn stature(&self) -> f64 {
        self.stature
    }

    /// The body mass \[kg\].
    pub fn mass(&self) -> f64 {
        self.mass
    }

    /// The ranges of motion \[rad\].
    pub fn ranges(&self) -> &JointRanges {
        &self.ranges
    }

    /// Returns the height of the elbow joint, standing with hanging arms \[m\].
    pub fn elbow_height(&self) -> f64 {
        (self.proportions.shoulder - self.proportions.upper_arm) * self.stature
    }

    /// Returns all lengths of the body \[m\].
    pub fn segments(&self) -> Segments {
        let length = |ratio: f64| Some(ratio * self.stature);
        let p = &self.proportions;
        Segments {
            ankle_height: length(p.ankle),
            knee_height: length(p.knee),
            hip_height: length(p.hip),
            shoulder_height: length(p.shoulder),
            eye_height: length(p.eye),
            upper_arm: length(p.upper_arm),
            forearm: length(p.forearm),
            grip: length(p.grip),
            shoulder_half_width: length(p.shoulder_half_width),
            foot: length(p.foot),
        }
    }

    pub(crate) fn proportions(&self) -> &Proportions {
        &self.proportions
    }
}
