//! Tolerances of the solver, each with its reason.
//!
//! A decision is compared with the rounding of its own sum, term by term: Σ|aᵢⱼ||xⱼ| + |bᵢ| for a
//! row's residual, and Σ|aᵢⱼ||rᵢ| of its column for a multiplier. The settings scale the quantities
//! that they name.

use std::ops::Range;

// Rounding.

/// Rounding of one operation, with a margin for the sums and rotations that a number goes through:
/// 45 units in the last place.
pub(crate) const ROUNDING: f64 = 1e-14;
/// A number this many times above its own rounding is certainly nonzero.
pub(crate) const CERTAIN: f64 = 10.0;
/// A multiplier above this part of its level's forces certainly exceeds rounding. Its own rounding
/// need not be computed, which saves time and decides nothing.
pub(crate) const CLEARLY_THERE: f64 = 1e-6;
/// Size of a row without coefficients, beside its bound. Such a row has nothing to be compared
/// with, and is judged in its own unit.
pub(crate) const NO_TERMS: f64 = 1.0;
/// A remainder of a row that has shrunk to this part of its square has lost half its digits to
/// cancellation. It is computed again.
pub(crate) const SHRUNK: f64 = 1e-4;

/// An x shorter than this part of where its search began has lost half of its digits to the rounding
/// of that start.
pub(crate) const SHORT: f64 = 1e-8;

/// Largest ratio of the forces of one level for which rotated bounds are accurate enough: half of
/// the digits.
pub(crate) const SCALE_DISPARITY: f64 = 1e8;

/// Forces below this part of the rounding in a gradient are ignored by a certificate.
pub(crate) const NEGLIGIBLE: f64 = 1e-3;

// Quadratics.

/// Pivots below this part of their diagonal entry of a Hessian count as zero.
pub(crate) const NO_CURVATURE: f64 = 1e-12;
/// Asymmetry and negative curvature in entry (i, j) are rounding up to this fraction of √(Hᵢᵢ Hⱼⱼ).
/// That is the largest possible entry in a semidefinite matrix, whatever the units of the
/// variables. There is a margin for matrices that are products of others, or were written with ten
/// digits.
pub(crate) const SHAPE: f64 = 1e-9;
/// A linear part below this part of its terms is rounding.
pub(crate) const LINEAR: f64 = 1e-9;

// Rank.

/// A part of a row below this, relative to the row, is rounding: that of its coefficients, 1e-13 if
/// they were computed, grown through pivots that leave a hundredth of their rows.
pub(crate) const NOTHING: f64 = 1e-11;
/// Part of a row, in units of the rank tolerance, below which the row may count as dependent if
/// other bounds are active. Its remainder has another size then.
pub(crate) const NEAR_THRESHOLD: f64 = 1e2;
/// Part of a row, in units of the rank tolerance, above which its independence is beyond doubt. An
/// updated factorisation needs no pivoting then. Below it, all rows are factored again.
pub(crate) const CLEAR: f64 = 1e4;
/// A dependent row this many times heavier than a pivot of its group requires a new factorisation,
/// in which heavy rows are pivots. A light pivot would lose the digits of the heavy row.
pub(crate) const HEAVIER: f64 = 16.0;

/// A row does not block a step along which it changes by less than this part of its norm times the
/// step. The rank tolerance may be larger. Such changes are noise of coefficients that has grown.
pub(crate) const MOTIONLESS: f64 = 1e-10;

/// Largest motion of x, relative to 1 + ‖x‖, that counts as rounding. Objectives above move no more
/// when a row becomes inactive on which they do not depend, since they are at their optimum.
pub(crate) const SETTLED: f64 = 1e-9;

// Sizes of numbers.

/// Products of the solver's numbers may overflow above this.
pub(crate) const MODERATE: f64 = 1e100;
/// Numbers whose squares have a smaller sum are all finite and moderate.
pub(crate) const MODERATE_SQUARE: f64 = MODERATE * MODERATE;
/// Norms of hard constraints that do not hide each other when they are made to hold together.
pub(crate) const NEAR_ONE: Range<f64> = 0.0625..32.0;

// Effort: these save time and decide nothing.

/// Least number of rounds of repairing a predicted active set before the levels are searched. A
/// search costs about as much as ten.
pub(crate) const ROUNDS: usize = 6;
/// Rounds of a repair after a search, and projections onto broken rows for each variable.
pub(crate) const ROUNDS_AFTER: usize = 20;
/// Iterations for each variable after which a search from a prediction gives up.
pub(crate) const LONG: usize = 10;
/// Weight of the newest solve in a row's mean, once there have been enough solves.
pub(crate) const NEWEST: f32 = 0.15;
/// Weight of the newest solve in the error rates of the predictions.
pub(crate) const NEWEST_SCORE: f64 = 0.1;
/// A prediction is repaired only if it is wrong in at most one row for this many variables, and in
/// one round for as many. Otherwise it is only the start of a search.
pub(crate) const FAR: usize = 6;
/// A change of more than one row for this many variables is a jump to another problem. It is not
/// used for the next prediction.
pub(crate) const JUMP: usize = 3;
/// A factorisation is updated instead of computed again for up to one change for this many
/// variables.
pub(crate) const UPDATED: usize = 8;
