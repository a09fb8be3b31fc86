//! Bodies of robot and person, placed in the world.

use nalgebra::Vector3;

use crate::contact::Contact;
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

/// How a part of the person's body moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredVelocity {
    /// As measured, in the world \[m/s\].
    pub mean: Vector3<f64>,
    /// How much faster than that the part may move, because the measurement is late and noisy \[m/s\].
    pub uncertainty: f64,
}

impl MeasuredVelocity {
    /// A velocity that is known exactly \[m/s\].
    pub fn exact(mean: Vector3<f64>) -> Self {
        Self { mean, uncertainty: 0.0 }
    }
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
