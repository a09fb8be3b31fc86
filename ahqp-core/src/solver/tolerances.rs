//! All numbers by which the solver decides, and the reason for each.
//!
//! A decision is judged against the rounding of its own sum, term by term: for a row's residual
//! Σ|aᵢⱼ||xⱼ| + |bᵢ|, for a multiplier Σ|aᵢⱼ||rᵢ| of its column. The settings scale what they name.

use std::ops::Range;

// Rounding.

/// The rounding of one operation, with room for the sums and rotations that a number goes through:
/// 45 units in the last place.
pub(crate) const ROUNDING: f64 = 1e-14;
/// A number this many times above its own rounding is certainly there.
pub(crate) const CERTAIN: f64 = 10.0;
/// Of the forces of a level, a multiplier above this part is no rounding: its own bound need not be
/// known, which saves time and decides nothing.
pub(crate) const CLEARLY_THERE: f64 = 1e-6;
/// Of ‖a‖‖x‖, what a search may leave of a violation that it cannot tell from rounding.
pub(crate) const DOUBTFUL: f64 = CERTAIN * ROUNDING;
/// The size of a row without coefficients beside its bound: that has nothing to compare with, and is judged in its
/// own unit.
pub(crate) const NO_TERMS: f64 = 1.0;
/// A step shorter than this part of 1 + ‖x‖ is no progress: where dozens of rows meet, a search could go round
/// for ever in steps of what rounding leaves of each.
pub(crate) const SHORTEST_STEP: f64 = 1e-12;
/// A remainder of a row that has shrunk to this part of its square has lost half its digits to
/// cancellation: it is computed anew.
pub(crate) const SHRUNK: f64 = 1e-4;

/// Forces of one level that differ by more than this are not left to rotated bounds: half of the digits.
pub(crate) const SPREAD: f64 = 1e8;

/// Of the rounding in a gradient, forces below this part are not looked at by a certificate.
pub(crate) const NEGLIGIBLE: f64 = 1e-3;

// Quadratics.

/// Of their diagonal entry of a Hessian, pivots below this count as zero.
pub(crate) const NO_CURVATURE: f64 = 1e-12;
/// Asymmetry and negative curvature in entry (i, j) up to this fraction of √(Hᵢᵢ Hⱼⱼ) are rounding: the
/// largest that the entry can be in a semidefinite matrix, whatever the units of the variables. Room for
/// matrices that are products of others, or were written with ten digits.
pub(crate) const SHAPE: f64 = 1e-9;
/// Of the terms it is made of, less of a linear part is rounding.
pub(crate) const LINEAR: f64 = 1e-9;

// Rank.

/// Less of a row, relative to it, is rounding, even where it stands in the way.
pub(crate) const NOTHING: f64 = 1e-12;
/// In parts of the rank tolerance: less of a row may be taken for dependent where other bounds are
/// active, as what remains of it then has another size.
pub(crate) const FAINT: f64 = 1e2;
/// In parts of the rank tolerance: more of a row is beyond doubt, an updated factorisation needs no
/// pivoting. Below, all rows are factored anew.
pub(crate) const CLEAR: f64 = 1e4;
/// A dependent row this many times heavier than a pivot of its group asks for a new factorisation, in
/// which heavy rows are pivots: a light pivot would lose the heavy row's digits.
pub(crate) const HEAVIER: f64 = 16.0;

/// Of 1 + ‖x‖, how far objectives above may move x where a row becomes inactive on which they do not depend:
/// they stand at their optimum already.
pub(crate) const SETTLED: f64 = 1e-9;

// Sizes of numbers.

/// Above this, products of the solver's numbers overflow.
pub(crate) const MODERATE: f64 = 1e100;
/// Numbers whose squares have a smaller sum are all finite and moderate.
pub(crate) const MODERATE_SQUARE: f64 = MODERATE * MODERATE;
/// Norms of hard constraints of which none hides another where they are made to hold together.
pub(crate) const NEAR_ONE: Range<f64> = 0.0625..32.0;

// Effort: what saves time and decides nothing.

/// Rounds of repairing a predicted active set after which the levels are searched.
pub(crate) const ROUNDS: usize = 20;
/// Iterations for each variable after which a search takes rows by least index.
pub(crate) const LONG: usize = 10;
/// The part that the newest solve has in a row's mean, once there have been enough of them.
pub(crate) const NEWEST: f32 = 0.15;
/// The same of how often the predictions are wrong.
pub(crate) const NEWEST_SCORE: f64 = 0.1;
/// A prediction that is wrong in more than one row in so many variables is not repaired: it is where a
/// search begins.
pub(crate) const FAR: usize = 6;
/// A change of more than one row in so many variables is a jump to another problem, and says nothing
/// of the next prediction.
pub(crate) const JUMP: usize = 3;
/// Up to one change in so many variables, a factorisation is updated and not made anew.
pub(crate) const UPDATED: usize = 8;
