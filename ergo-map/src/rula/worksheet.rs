use super::score::{Rula, RulaSubScores};
use crate::error::{Result, angle, within};
use crate::posture::Posture;
use crate::steps::Steps;

/// Upper arm: within 20° 1; 20-45° flexion or more than 20° extension 2; 45-90° 3; more 4.
const UPPER_ARM: Steps = Steps::new(2.0, &[(-20.0, -1.0), (20.0, 1.0), (45.0, 1.0), (90.0, 1.0)]);
/// Lower arm: elbow flexion 60-100° 1, otherwise 2.
const LOWER_ARM: Steps = Steps::new(2.0, &[(60.0, -1.0), (100.0, 1.0)]);
/// Wrist: neutral (within 5°) 1; up to 15° 2; more 3.
const WRIST: Steps = Steps::new(3.0, &[(-15.0, -1.0), (-5.0, -1.0), (5.0, 1.0), (15.0, 1.0)]);
/// Neck: 0-10° flexion 1; 10-20° 2; more 3; extension 4.
const NECK: Steps = Steps::new(4.0, &[(0.0, -3.0), (10.0, 1.0), (20.0, 1.0)]);
/// Trunk: upright (within 5°) 1; up to 20° 2; up to 60° flexion 3; more 4. Extension as in REBA.
const TRUNK: Steps =
    Steps::new(3.0, &[(-20.0, -1.0), (-5.0, -1.0), (5.0, 1.0), (20.0, 1.0), (60.0, 1.0)]);

/// Magnitudes \[°\] above which a box is ticked, as for REBA.
const TRUNK_TURNED: Steps = Steps::new(0.0, &[(10.0, 1.0)]);
const NECK_TURNED: Steps = Steps::new(0.0, &[(20.0, 1.0)]);
const ABDUCTED: Steps = Steps::new(0.0, &[(32.5, 1.0)]);
/// Threshold of the upper arm's rotation for work across the body's midplane or out to the side.
const ACROSS: Steps = Steps::new(0.0, &[(45.0, 1.0)]);
const DEVIATED: Steps = Steps::new(0.0, &[(10.0, 1.0)]);
/// Threshold of the forearm's twist near the end of its range.
const TWISTED: Steps = Steps::new(0.0, &[(45.0, 1.0)]);

/// Course of a load over time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum LoadPattern {
    /// Occasional load.
    #[default]
    Intermittent,
    /// Load that is held, or repeated.
    StaticOrRepeated,
    /// A load with shock, or one that builds up rapidly.
    Shock,
}

/// A completed RULA sheet. Angles are in radians, with positive flexion.
///
/// ```
/// use ergo_map::RulaWorksheet;
/// let sheet = RulaWorksheet { neck_flexion: 0.5, trunk_flexion: 0.5, ..Default::default() };
/// assert_eq!(sheet.score()?.sub_scores.neck, 3);
/// # Ok::<(), ergo_map::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[allow(clippy::struct_excessive_bools)] // the tick boxes of the printed sheet
pub struct RulaWorksheet {
    /// Flexion of the upper arm.
    pub upper_arm_flexion: f64,
    /// The shoulder is raised.
    pub shoulder_raised: bool,
    /// The upper arm is abducted.
    pub arm_abducted: bool,
    /// The arm is supported, or the person leans.
    pub arm_supported: bool,
    /// Flexion of the elbow.
    pub elbow_flexion: f64,
    /// The arm works across the body's midplane or out to the side.
    pub arm_across_or_out: bool,
    /// Flexion of the wrist.
    pub wrist_flexion: f64,
    /// The wrist is bent away from its midline.
    pub wrist_deviated: bool,
    /// The forearm is twisted to near the end of its range.
    pub wrist_twisted: bool,
    /// Flexion of the neck.
    pub neck_flexion: f64,
    /// The neck is twisted.
    pub neck_twisted: bool,
    /// The neck is bent sideways.
    pub neck_bent: bool,
    /// Inclination of the trunk from the vertical.
    pub trunk_flexion: f64,
    /// The trunk is twisted.
    pub trunk_twisted: bool,
    /// The trunk is bent sideways.
    pub trunk_bent: bool,
    /// Legs and feet are not well supported, or out of balance.
    pub legs_unsupported: bool,
    /// The posture is mainly static, or repeats more than four times a minute.
    pub muscle_use: bool,
    /// Load or force \[kg\].
    pub load: f64,
    /// Course of the load over time.
    pub load_pattern: LoadPattern,
}

impl RulaWorksheet {
    /// Completes the sheet's angles and posture boxes from a posture. The legs are supported, and
    /// there is no muscle use and no load.
    ///
    /// The upper arm's flexion is its elevation, as in [`crate::Worksheet::from_posture`]. Boxes
    /// are ticked above the magnitudes named there, and "across or out" above 45° of upper-arm
    /// rotation.
    pub fn from_posture(posture: &Posture) -> Self {
        let ticked = |steps: Steps, angle: f64| steps.class(angle.abs()) > 0;
        let arm = posture.upper_arm();
        Self {
            upper_arm_flexion: arm.sheet_flexion(),
            arm_abducted: ticked(ABDUCTED, arm.abduction()),
            elbow_flexion: posture.elbow_flexion,
            arm_across_or_out: ticked(ACROSS, posture.upper_arm_rotation),
            wrist_flexion: posture.wrist_flexion,
            wrist_deviated: ticked(DEVIATED, posture.wrist_deviation),
            wrist_twisted: ticked(TWISTED, posture.wrist_twist),
            neck_flexion: posture.neck_flexion,
            neck_twisted: ticked(NECK_TURNED, posture.neck_twist),
            neck_bent: ticked(NECK_TURNED, posture.neck_side),
            trunk_flexion: posture.trunk_flexion,
            trunk_twisted: ticked(TRUNK_TURNED, posture.trunk_twist),
            trunk_bent: ticked(TRUNK_TURNED, posture.trunk_side),
            ..Self::default()
        }
    }

    /// Returns the score with every sub-score.
    ///
    /// # Errors
    /// [`crate::Error::Value`] if an angle or the load is invalid.
    pub fn score(&self) -> Result<Rula> {
        angle("upper_arm_flexion", self.upper_arm_flexion)?;
        angle("elbow_flexion", self.elbow_flexion)?;
        angle("wrist_flexion", self.wrist_flexion)?;
        angle("neck_flexion", self.neck_flexion)?;
        angle("trunk_flexion", self.trunk_flexion)?;
        within("load", self.load, [0.0, 1000.0], "kg")?;
        Ok(Rula::new(self.sub_scores(), u8::from(self.muscle_use), self.load_score()))
    }

    fn sub_scores(&self) -> RulaSubScores {
        let upper_arm = UPPER_ARM.class(self.upper_arm_flexion)
            + u8::from(self.shoulder_raised)
            + u8::from(self.arm_abducted);
        RulaSubScores {
            upper_arm: upper_arm.saturating_sub(u8::from(self.arm_supported)).max(1),
            lower_arm: LOWER_ARM.class(self.elbow_flexion) + u8::from(self.arm_across_or_out),
            wrist: WRIST.class(self.wrist_flexion) + u8::from(self.wrist_deviated),
            wrist_twist: 1 + u8::from(self.wrist_twisted),
            neck: NECK.class(self.neck_flexion)
                + u8::from(self.neck_twisted)
                + u8::from(self.neck_bent),
            trunk: TRUNK.class(self.trunk_flexion)
                + u8::from(self.trunk_twisted)
                + u8::from(self.trunk_bent),
            legs: 1 + u8::from(self.legs_unsupported),
        }
    }

    /// Returns the score of the load. Below 2 kg it is 0. It is 1 for 2 to 10 kg, or 2 if static or
    /// repeated. Above it is 2, or 3 if static or repeated. Shock is always 3. A static or repeated
    /// load below 2 kg is 0.
    fn load_score(&self) -> u8 {
        let heavy = self.load > 10.0;
        match self.load_pattern {
            LoadPattern::Shock => 3,
            _ if self.load < 2.0 => 0,
            LoadPattern::Intermittent => 1 + u8::from(heavy),
            LoadPattern::StaticOrRepeated => 2 + u8::from(heavy),
        }
    }
}
