//! Bodies of robot and person, placed in the world.

use crate::contact::Contact;
use crate::measured_velocity::MeasuredVelocity;
#[cfg(doc)]
use crate::separation::SeparationSettings;
use crate::shape::Capsule;

/// A body of the robot, placed in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RobotBody {
    /// Its shape in the world \[m\].
    pub capsule: Capsule,
    /// How many of the joints, from the first, move it.
    pub joints: usize,
}

/// A part of the person's body, placed in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PersonBody {
    /// Its shape in the world \[m\].
    pub capsule: Capsule,
    /// Its velocity; unmeasured, the person is taken to come nearer at
    /// [`SeparationSettings::human_speed`].
    pub velocity: Option<MeasuredVelocity>,
    /// For a part that the robot may touch now: whatever the distance, the two may come nearer to each
    /// other as fast as their contact allows. None where only the distance counts.
    pub contact: Option<Contact>,
}
