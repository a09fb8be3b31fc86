//! What counts as rounding in residuals and multipliers: each is judged against the sum that it is made
//! of, term by term.

/// The rounding of one operation, with room for the sums and rotations that a number goes through:
/// 45 units in the last place.
pub(crate) const ROUNDING: f64 = 1e-14;
/// A number this many times above its own rounding is certainly there.
pub(crate) const CERTAIN: f64 = 10.0;
/// A multiplier above this part of its level's forces is no rounding: its own bound need not be known.
pub(crate) const CLEARLY_THERE: f64 = 1e-6;
