//! Settings of the separation from people.

use crate::body_region::ContactLimits;
use crate::error::{Error, not_negative, positive};
use crate::link_capsule::LinkCapsule;
use crate::separation::SeparationSettings;
use crate::supervisor::SupervisorSettings;

/// Separation from people and from the robot itself. **This is not safety-rated.**
///
/// ```
/// use hrsw_safety::{Capsule, LinkCapsule, SafetySettings};
/// use nalgebra::Vector3;
///
/// let capsule = Capsule::new(Vector3::zeros(), Vector3::new(0.0, 0.0, 0.1), 0.05)?;
/// let gripper = LinkCapsule { link: "gripper".to_owned(), capsule };
/// let settings = SafetySettings { bodies: vec![gripper], ..SafetySettings::default() };
/// assert!(settings.validate().is_ok());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct SafetySettings {
    /// Terms of the protective distance. Default: those of [`SeparationSettings`] with C = 0.05 m,
    /// since every part of the body is tracked, and with the braking of the robot's base.
    pub separation: SeparationSettings,
    /// Limits of a contact with a part of the person. Default: those of [`ContactLimits`],
    /// quasi-static.
    pub contact: ContactLimits,
    /// Largest speed at which the robot and a person who works with it may approach each other
    /// \[m/s\]. Contact limits may lower it. Default 0.25.
    pub contact_speed: f64,
    /// Rules by which the robot stops and recovers. Default: those of [`SupervisorSettings`].
    pub supervisor: SupervisorSettings,
    /// Standard deviation of the place of a person's joint for each axis, if no covariance is known
    /// \[m\]. Default 0.02.
    pub position_sigma: f64,
    /// Capsules of the robot, best from the gripper to the base: the nearest are then found first.
    /// A robot without capsules keeps no distance from people. Default: those of the robot, none if
    /// the robot is not known.
    pub bodies: Vec<LinkCapsule>,
    /// Pairs of these capsules that are kept apart, by index. Default: those of the robot.
    pub own_pairs: Vec<(usize, usize)>,
}

/// Settings of a robot without capsules, since these depend on the robot.
impl Default for SafetySettings {
    fn default() -> Self {
        Self {
            separation: SeparationSettings { intrusion: 0.05, ..SeparationSettings::default() },
            contact: ContactLimits::default(),
            contact_speed: 0.25,
            supervisor: SupervisorSettings::default(),
            position_sigma: 0.02,
            bodies: Vec::new(),
            own_pairs: Vec::new(),
        }
    }
}

impl SafetySettings {
    /// Returns the settings without capsules and rows, and without stops for old frames once one
    /// frame has come. The robot keeps no distance from people and may collide with itself. Forces
    /// from outside still stop it. This is for simulations and comparisons.
    ///
    /// ```
    /// use hrsw_safety::SafetySettings;
    ///
    /// let off = SafetySettings::default().off();
    /// assert!(!off.keeps_distances() && off.validate().is_ok());
    /// ```
    #[must_use]
    pub fn off(self) -> Self {
        Self {
            bodies: Vec::new(),
            own_pairs: Vec::new(),
            supervisor: SupervisorSettings {
                reduced_age: f64::MAX,
                stop_age: f64::MAX,
                ..self.supervisor
            },
            ..self
        }
    }

    /// Returns true if the robot has capsules, and so keeps distances from people.
    pub fn keeps_distances(&self) -> bool {
        !self.bodies.is_empty()
    }

    /// Checks the ranges.
    ///
    /// # Errors
    /// [`Error::Value`] names the first setting that is out of its range.
    pub fn validate(&self) -> Result<(), Error> {
        self.separation.validate()?;
        self.supervisor.validate()?;
        positive("safety.position_sigma", self.position_sigma)?;
        not_negative("safety.contact_speed", self.contact_speed)?;
        Ok(())
    }
}
