//! Velocities of parts of a person's body.

use nalgebra::Vector3;

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
