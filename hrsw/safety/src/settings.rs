//! How the robot keeps its distance.

use crate::body_region::ContactLimits;
use crate::error::{Error, check_count, not_negative, positive};
use crate::link_capsule::LinkCapsule;
use crate::separation::SeparationSettings;
use crate::speed_cap::SpeedCap;
use crate::supervisor::SupervisorSettings;

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
/// use hrsw_safety::{Capsule, LinkCapsule, SafetySettings};
/// use nalgebra::Vector3;
///
/// let capsule = Capsule::new(Vector3::zeros(), Vector3::new(0.0, 0.0, 0.1), 0.05)?;
/// let hand = LinkCapsule { link: "hand".to_owned(), capsule };
/// let settings = SafetySettings { bodies: vec![hand], ..SafetySettings::default() };
/// assert!(settings.validate().is_ok());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct SafetySettings {
    /// The terms of the protective distance. Default: that of [`SeparationSettings`] with C = 0.05 m, since every
    /// part of the body is tracked, and the braking of the robot's base.
    pub separation: SeparationSettings,
    /// Pairs of a robot's and a person's body that get a row. Default 40.
    pub pairs: usize,
    /// What a contact with a part of the person may do. Default: that of [`ContactLimits`], quasi-static.
    pub contact: ContactLimits,
    /// How fast the robot and a person who works with it may come nearer to each other, where the limits
    /// of a contact allow it \[m/s\]. Default 0.25.
    pub contact_speed: f64,
    /// How fast that comes and goes when working together begins and ends \[m/s²\]. Default 1.
    pub contact_acceleration: f64,
    /// The cap on the tool's speed relative to the person. Default that of [`SpeedCap`].
    pub speed_cap: SpeedCap,
    /// When the robot stops, and when it recovers. Default: that of [`SupervisorSettings`] without reduced speed near
    /// people, which the other terms see to, with no tolerance, a hysteresis of 0.03 m, a dwell
    /// time of 0.2 s, half the speed when reduced, and a ramp of 0.25 s.
    pub supervisor: SupervisorSettings,
    /// The person's body.
    pub person: PersonBodySettings,
    /// The robot's bodies, best from the hand down: the nearest are then found first. Default: those of the robot,
    /// none where it is not known.
    pub bodies: Vec<LinkCapsule>,
    /// Pairs of those that are kept apart, by index. Default: those of the robot.
    pub own_pairs: Vec<(usize, usize)>,
    /// Pairs of the robot's own bodies that get a row. Default 6.
    pub own_rows: usize,
    /// Margin between them \[m\]. Default 0.03.
    pub own_margin: f64,
    /// How fast the arm brakes before itself \[m/s²\]. Default 2.
    pub own_deceleration: f64,
}

/// A robot without bodies: those are its own.
impl Default for SafetySettings {
    fn default() -> Self {
        Self {
            separation: SeparationSettings { intrusion: 0.05, ..SeparationSettings::default() },
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
            bodies: Vec::new(),
            own_pairs: Vec::new(),
            own_rows: 6,
            own_margin: 0.03,
            own_deceleration: 2.0,
        }
    }
}

impl SafetySettings {
    /// The same with no bodies, no rows, and no stops once a camera frame has come: people are not kept at a
    /// distance, and the robot may touch itself. Forces from outside still stop it. For simulations and
    /// comparisons.
    ///
    /// ```
    /// use hrsw_safety::SafetySettings;
    ///
    /// let off = SafetySettings::default().off();
    /// assert!(off.pairs == 0 && off.validate().is_ok());
    /// ```
    #[must_use]
    pub fn off(self) -> Self {
        Self {
            pairs: 0,
            bodies: Vec::new(),
            own_pairs: Vec::new(),
            own_rows: 0,
            supervisor: SupervisorSettings {
                reduced_age: f64::MAX,
                stop_age: f64::MAX,
                ..self.supervisor
            },
            ..self
        }
    }

    /// Checks the ranges.
    ///
    /// # Errors
    /// [`Error::Value`] names the first that is out of its range.
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
            positive(name, value)?;
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
            not_negative(name, value)?;
        }
        if !(0.0..=1.0).contains(&self.person.least_confidence) {
            let (what, got) = ("safety.person.least_confidence", self.person.least_confidence);
            return Err(Error::Value { what, got, wanted: "between 0 and 1" });
        }
        Ok(())
    }
}
