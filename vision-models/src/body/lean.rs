//! Where the neck is, seen from above the pelvis.

use nalgebra::{Rotation2, Vector2};

/// How far the neck may be from above the pelvis, each axis, before it was measured (m).
const UNKNOWN: f64 = 0.08;

/// How fast people change their posture: the spectral density of the change (m²/s).
const DENSITY: f64 = 0.0004;

/// What remains unknown (m²).
const LEAST: f64 = 0.000_4;

/// The neck's place on the floor plan from the pelvis, in the person's frame: a Kalman filter of a
/// random walk. With it the neck tells where a hidden pelvis is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lean {
    /// Forwards and to the left (m).
    offset: Vector2<f64>,
    /// Of each axis (m²).
    variance: f64,
    time: f64,
}

impl Default for Lean {
    fn default() -> Self {
        Self { offset: Vector2::zeros(), variance: UNKNOWN.powi(2), time: f64::NEG_INFINITY }
    }
}

/// The same in the world (m), with the variance of each axis (m²).
#[derive(Clone, Copy, Debug)]
pub(super) struct LeanInWorld {
    pub(super) offset: Vector2<f64>,
    pub(super) variance: f64,
}

impl Lean {
    /// For a person of this heading (rad) at this time (s).
    pub(super) fn in_world(&self, heading: f64, time: f64) -> LeanInWorld {
        let variance = (self.variance_at(time) + LEAST).min(UNKNOWN.powi(2) + LEAST);
        LeanInWorld { offset: Rotation2::new(heading) * self.offset, variance }
    }

    /// Takes in where the neck is from the pelvis in the world (m), with the variance of each axis.
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
