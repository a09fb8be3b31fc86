//! Measured velocities of parts of a person's body.

use nalgebra::Vector3;

/// Measured velocity of a part of the person's body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredVelocity {
    /// Measured velocity in the world frame \[m/s\].
    pub mean: Vector3<f64>,
    /// Largest speed relative to `mean`, because the measurement is late and noisy \[m/s\].
    pub uncertainty: f64,
}

impl MeasuredVelocity {
    /// Creates a velocity that is known exactly \[m/s\].
    pub fn exact(mean: Vector3<f64>) -> Self {
        Self { mean, uncertainty: 0.0 }
    }

    /// Returns the speed of the part along a unit normal that points away from it.
    pub(crate) fn towards(&self, normal: &Vector3<f64>) -> SpeedTowards {
        let measured = self.mean.dot(normal);
        SpeedTowards { measured, worst: measured + self.uncertainty }
    }
}

/// Speed at which a part of the person approaches \[m/s\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SpeedTowards {
    /// Measured speed.
    pub(crate) measured: f64,
    /// Speed in the worst case of the measurement.
    pub(crate) worst: f64,
}
