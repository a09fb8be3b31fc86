//! The neck's position relative to the pelvis, seen from above.

use nalgebra::{Rotation2, Vector2};

/// Standard deviation of the neck's horizontal offset on each axis before it is measured (m).
const UNKNOWN: f64 = 0.08;

/// Spectral density of the change of posture (m²/s).
const DENSITY: f64 = 0.0004;

/// Smallest remaining variance (m²).
const LEAST: f64 = 0.000_4;

/// Horizontal offset of the neck from the pelvis in the person's frame, filtered by a Kalman filter
/// of a random walk. It gives the position of a hidden pelvis from the neck.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lean {
    /// Offset forwards and to the left (m).
    offset: Vector2<f64>,
    /// Variance of each axis (m²).
    variance: f64,
    time: f64,
}

impl Default for Lean {
    fn default() -> Self {
        Self { offset: Vector2::zeros(), variance: UNKNOWN.powi(2), time: f64::NEG_INFINITY }
    }
}

/// The offset in the world frame (m), with the variance of each axis (m²).
#[derive(Clone, Copy, Debug)]
pub(super) struct LeanInWorld {
    pub(super) offset: Vector2<f64>,
    pub(super) variance: f64,
}

impl Lean {
    /// Returns the offset in the world for a person with this heading (rad) at this time (s).
    pub(super) fn in_world(&self, heading: f64, time: f64) -> LeanInWorld {
        let variance = (self.variance_at(time) + LEAST).min(UNKNOWN.powi(2) + LEAST);
        LeanInWorld { offset: Rotation2::new(heading) * self.offset, variance }
    }

    /// Updates the filter with a measured offset in the world (m) and the variance of each axis
    /// (m²).
    pub(super) fn update(&mut self, offset: &Vector2<f64>, variance: f64, heading: f64, time: f64) {
        let before = self.variance_at(time);
        let gain = before / (before + variance);
        let measured = Rotation2::new(-heading) * offset;
        if gain.is_finite() && measured.norm() < 1.0 {
            self.offset += (measured - self.offset) * gain;
            self.variance = before * (1.0 - gain);
            self.time = time;
        }
    }

    fn variance_at(&self, time: f64) -> f64 {
        let elapsed = (time - self.time).max(0.0);
        if elapsed.is_finite() { self.variance + DENSITY * elapsed } else { self.variance }
    }
}

impl Default for LeanInWorld {
    fn default() -> Self {
        Lean::default().in_world(0.0, 0.0)
    }
}
