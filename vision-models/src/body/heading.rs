//! The heading of a person in one camera frame.

/// The heading in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Heading {
    /// Angle in (-π, π] (rad).
    pub(super) angle: f64,
    /// Variance, if it is known (rad²).
    pub(super) variance: Option<f64>,
    /// Share of the variance that lasts.
    pub(super) lasting: f64,
}
