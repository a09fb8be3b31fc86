//! A point with its score.

use nalgebra::Vector3;

/// A hand position \[m\] with the score there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScoredPoint {
    /// Hand position.
    pub position: Vector3<f64>,
    /// The score, usually `e_s`.
    pub score: f64,
}
