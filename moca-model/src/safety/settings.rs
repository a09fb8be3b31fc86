//! How the robot keeps its distance, with defaults for MOCA.

use hrsw::{BaseBraking, Capsule, ContactLimits, SeparationSettings, SpeedCap, SupervisorSettings};
use nalgebra::Vector3;

use crate::error::Error;
use crate::robot::bodies::LinkCapsule;
use crate::robot::moca::MOCA_BASE_JOINTS;
use crate::settings::check_count;

/// How the person's body is made of what the camera sees.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct PersonBodySettings {
    /// Keypoints with less confidence are as good as missing \[-\]. Default 0.5.
    pub least_confidence: f64,
    /// A joint that moved farther against the trunk since the frame before counts as missing, unless
    /// it is seen there again in the next \[m\]. Default 0.3.
    pub limb_gate: f64,
    /// Who moves faster than this from frame to frame jumped: velocities are then measured anew \[m/s\].
    /// Default 1.6.
    pub jump_speed: f64,
    /// The velocity of a joint that was not seen for longer than this is measured anew \[s\]. Default 0.5.
    pub gap: f64,
    /// Somebody who is seen no farther than this from where another was is the same \[m\]. Default 0.25.
    pub agreement: f64,
    /// How long a joint must have been seen for its velocity to count \[s\]. Default 0.3.
    pub settling: f64,
    /// How long the velocity measured last is believed, with an uncertainty that grows \[s\]. Default 0.5.
    pub believed_for: f64,
    /// Standard deviation of where a joint is seen, each axis, where no covariance is known \[m\]. Default 0.02.
    pub position_sigma: f64,
    /// Standard deviation of the acceleration of somebody who stands \[m/s²\]: how soon they may begin to lean or
    /// to walk. Default 1.6.
    pub acceleration: f64,
    /// The same of the trunk of somebody who works with the robot \[m/s²\]: for contacts a part moves as the trunk
    /// until its own joints show that it does not. Default 0.4.
    pub working_acceleration: f64,
    /// How many standard deviations faster than measured a part may be \[-\]. Default 3.
    pub speed_deviations: f64,
    /// How much faster than measured it may be for each second since it was seen \[m/s²\]. Default 1.
    pub onset: f64,
    /// After how long without being seen a person is taken to have left \[s\]. Until then what is
    /// not seen grows as fast as a person may come nearer. Default 10.
    pub forget_after: f64,
}

impl Default for PersonBodySettings {
    fn default() -> Self {
        Self {
            least_confidence: 0.5,
            limb_gate: 0.3,
            jump_speed: 1.6,
            gap: 0.5,
            agreement: 0.25,
            settling: 0.3,
            believed_for: 0.5,
            position_sigma: 0.02,
            acceleration: 1.6,
            working_acceleration: 0.4,
            speed_deviations: 3.0,
            onset: 1.0,
            forget_after: 10.0,
        }
    }
}

/// Separation from people and from the robot itself. **This is not safety-rated.**
///
/// ```
/// use moca_model::SafetySettings;
///
/// let settings = SafetySettings::default();
/// assert_eq!(settings.bodies.len(), 20);
/// assert!(settings.validate().is_ok());
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct SafetySettings {
    /// The terms of the protective distance. Default: that of hrsw with C = 0.05 m, since every
    /// part of the body is tracked, and a = 0.5 m/s² for MOCA's base.
    pub separation: SeparationSettings,
    /// Pairs of a robot's and a person's body that get a row. Default 40.
    pub pairs: usize,
    /// What a contact with a part of the person may do. Default: hrsw's, quasi-static.
    pub contact: ContactLimits,
    /// How fast the robot and a person who works with it may come nearer to each other, where the limits
    /// of a contact allow it \[m/s\]. Default 0.25.
    pub contact_speed: f64,
    /// How fast that comes and goes when working together begins and ends \[m/s²\]. Default 1.
    pub contact_acceleration: f64,
    /// The cap on the tool's speed relative to the person. Default that of hrsw.
    pub speed_cap: SpeedCap,
    /// When the robot stops, and when it recovers. Default: hrsw's without reduced speed near
    /// people, which the other terms see to, with no tolerance, a hysteresis of 0.03 m, a dwell
    /// time of 0.2 s, half the speed when reduced, and a ramp of 0.25 s.
    pub supervisor: SupervisorSettings,
    /// The person's body.
    pub person: PersonBodySettings,
    /// The robot's bodies. Default: the Panda's self-collision capsules as its maker's description
    /// gives them, and eight around the chassis of the base.
    pub bodies: Vec<LinkCapsule>,
    /// Pairs of those that are kept apart, by index. Default: the chassis and the links from the
    /// elbow on, the shoulder and those from the forearm on.
    pub own_pairs: Vec<(usize, usize)>,
    /// Pairs of the robot's own bodies that get a row. Default 6.
    pub own_rows: usize,
    /// Margin between them \[m\]. Default 0.03.
    pub own_margin: f64,
    /// How fast the arm brakes before itself \[m/s²\]. Default 2.
    pub own_deceleration: f64,
}

impl Default for SafetySettings {
    fn default() -> Self {
        let bodies = moca_bodies();
        let own_pairs = moca_own_pairs(&bodies);
        Self {
            separation: SeparationSettings {
                intrusion: 0.05,
                base: Some(BaseBraking { joints: MOCA_BASE_JOINTS, deceleration: 0.5 }),
                ..SeparationSettings::default()
            },
            pairs: 40,
            contact: ContactLimits::default(),
            contact_speed: 0.25,
            contact_acceleration: 1.0,
            speed_cap: SpeedCap::default(),
            supervisor: SupervisorSettings {
                tolerance: 0.0,
                hysteresis: 0.03,
                dwell: 0.2,
                reduced_scale: 0.5,
                ramp: 0.25,
                ..SupervisorSettings::default()
            },
            person: PersonBodySettings::default(),
            bodies,
            own_pairs,
            own_rows: 6,
            own_margin: 0.03,
            own_deceleration: 2.0,
        }
    }
}

impl SafetySettings {
    /// No bodies, no rows, and no stops once a camera frame has come: people are not kept at a
    /// distance, and the robot may touch itself. Forces from outside still stop it. For simulations and
    /// comparisons.
    ///
    /// ```
    /// use moca_model::SafetySettings;
    ///
    /// let off = SafetySettings::off();
    /// assert!(off.bodies.is_empty() && off.validate().is_ok());
    /// ```
    pub fn off() -> Self {
        let defaults = Self::default();
        Self {
            pairs: 0,
            bodies: Vec::new(),
            own_pairs: Vec::new(),
            own_rows: 0,
            supervisor: SupervisorSettings {
                reduced_age: f64::MAX,
                stop_age: f64::MAX,
                ..defaults.supervisor
            },
            ..defaults
        }
    }

    /// Checks the ranges.
    ///
    /// # Errors
    /// [`Error::Setting`], or [`Error::Workspace`] for the parts that hrsw checks.
    pub fn validate(&self) -> Result<(), Error> {
        self.separation.validate()?;
        self.speed_cap.validate()?;
        self.supervisor.validate()?;
        check_count("safety.pairs", self.pairs)?;
        check_count("safety.own_rows", self.own_rows)?;
        for (name, value) in [
            ("safety.contact_acceleration", self.contact_acceleration),
            ("safety.own_deceleration", self.own_deceleration),
            ("safety.person.settling", self.person.settling),
            ("safety.person.believed_for", self.person.believed_for),
            ("safety.person.forget_after", self.person.forget_after),
            ("safety.person.position_sigma", self.person.position_sigma),
            ("safety.person.acceleration", self.person.acceleration),
            ("safety.person.working_acceleration", self.person.working_acceleration),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(Error::Setting { name, value, expected: "positive and finite" });
            }
        }
        for (name, value) in [
            ("safety.contact_speed", self.contact_speed),
            ("safety.own_margin", self.own_margin),
            ("safety.person.limb_gate", self.person.limb_gate),
            ("safety.person.jump_speed", self.person.jump_speed),
            ("safety.person.gap", self.person.gap),
            ("safety.person.agreement", self.person.agreement),
            ("safety.person.speed_deviations", self.person.speed_deviations),
            ("safety.person.onset", self.person.onset),
        ] {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(Error::Setting { name, value, expected: "finite and not negative" });
            }
        }
        if !(0.0..=1.0).contains(&self.person.least_confidence) {
            let (name, value) = ("safety.person.least_confidence", self.person.least_confidence);
            return Err(Error::Setting { name, value, expected: "between 0 and 1" });
        }
        Ok(())
    }
}

/// Link, centre, direction of the axis, radius, distance between the centres of the ends \[m\].
type Row = (&'static str, [f64; 3], [f64; 3], f64, f64);

/// The Panda's self-collision capsules, from the maker's description of the robot.
const PANDA: [Row; 12] = {
    /// The frame of link 7's capsules is turned by an eighth about z.
    const D: f64 = std::f64::consts::FRAC_1_SQRT_2;
    const X: [f64; 3] = [1.0, 0.0, 0.0];
    const Y: [f64; 3] = [0.0, 1.0, 0.0];
    const Z: [f64; 3] = [0.0, 0.0, 1.0];
    [
        ("panda_link0", [-0.075, 0.0, 0.06], X, 0.06, 0.03),
        ("panda_link1", [0.0, 0.0, -0.1915], Z, 0.06, 0.283),
        ("panda_link2", [0.0, 0.0, 0.0], Z, 0.06, 0.12),
        ("panda_link3", [0.0, 0.0, -0.145], Z, 0.06, 0.15),
        ("panda_link4", [0.0, 0.0, 0.0], Z, 0.06, 0.12),
        ("panda_link5", [0.0, 0.0, -0.26], Z, 0.06, 0.10),
        ("panda_link5", [0.0, 0.08, -0.13], Z, 0.025, 0.14),
        ("panda_link6", [0.0, 0.0, -0.03], Z, 0.05, 0.08),
        ("panda_link7", [0.0, 0.0, 0.01], Z, 0.04, 0.14),
        ("panda_link7", [0.06 * D, 0.06 * D, 0.082], [D, D, 0.0], 0.03, 0.01),
        ("panda_hand", [0.0, 0.0, 0.04], Y, 0.04, 0.10),
        ("panda_hand", [0.0, 0.0, 0.10], Y, 0.02, 0.10),
    ]
};

/// Around the chassis' box of 0.719 × 0.579 × 0.443 m: across at front and back, along at both
/// sides, each low and high, just large enough to hold its surface but for the inside of the deck.
const CHASSIS: [Row; 8] = {
    const X: [f64; 3] = [1.0, 0.0, 0.0];
    const Y: [f64; 3] = [0.0, 1.0, 0.0];
    [
        ("base_link", [0.28, 0.0, 0.05], Y, 0.155, 0.44),
        ("base_link", [0.28, 0.0, 0.271], Y, 0.155, 0.44),
        ("base_link", [-0.28, 0.0, 0.05], Y, 0.155, 0.44),
        ("base_link", [-0.28, 0.0, 0.271], Y, 0.155, 0.44),
        ("base_link", [0.0, 0.21, 0.05], X, 0.155, 0.56),
        ("base_link", [0.0, 0.21, 0.271], X, 0.155, 0.56),
        ("base_link", [0.0, -0.21, 0.05], X, 0.155, 0.56),
        ("base_link", [0.0, -0.21, 0.271], X, 0.155, 0.56),
    ]
};

fn moca_bodies() -> Vec<LinkCapsule> {
    // From the hand down: the nearest are found first, and many others need no search.
    PANDA
        .iter()
        .rev()
        .chain(&CHASSIS)
        .filter_map(|&(link, centre, axis, radius, length)| {
            let (centre, half) = (Vector3::from(centre), Vector3::from(axis) * (0.5 * length));
            let capsule = Capsule::new(centre - half, centre + half, radius).ok()?;
            Some(LinkCapsule { link: link.to_owned(), capsule })
        })
        .collect()
}

fn moca_own_pairs(bodies: &[LinkCapsule]) -> Vec<(usize, usize)> {
    let of = |links: &[&str]| -> Vec<usize> {
        let named = |(_, body): &(usize, &LinkCapsule)| links.contains(&body.link.as_str());
        bodies.iter().enumerate().filter(named).map(|(index, _)| index).collect()
    };
    let across = |first: &[&str], second: &[&str]| -> Vec<(usize, usize)> {
        let second = of(second);
        of(first)
            .into_iter()
            .flat_map(|i| second.iter().map(move |&j| (i, j)).collect::<Vec<_>>())
            .collect()
    };
    let wrist = ["panda_link5", "panda_link6", "panda_link7", "panda_hand"];
    let mut pairs = across(&wrist, &["base_link", "panda_link0", "panda_link1"]);
    pairs.extend(across(&["panda_link4"], &["base_link"]));
    pairs
}
