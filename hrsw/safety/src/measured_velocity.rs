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

    /// How fast the part comes nearer along a unit normal that points away from it.
    pub(crate) fn towards(&self, normal: &Vector3<f64>) -> SpeedTowards {
        let measured = self.mean.dot(normal);
        SpeedTowards { measured, worst: measured + self.uncertainty }
    }
}

/// How fast a part of the person comes nearer \[m/s\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SpeedTowards {
    /// As measured.
    pub(crate) measured: f64,
    /// If the measurement is as wrong as it may be.
    pub(crate) worst: f64,
}
