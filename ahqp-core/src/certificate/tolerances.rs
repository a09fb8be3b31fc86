//! All numbers by which a certificate is found and checked, and the reason for each.
//!
//! They are its own: what the solver calls rounding, or dependent, decides nothing here.

// The check.

/// Of the numbers around it, a smaller violation counts as none.
pub(crate) const VIOLATION: f64 = 1e-9;
/// Of the gradient of its level, a smaller multiplier is rounding.
pub(crate) const MULTIPLIER: f64 = 1e-13;
/// The rounding of a product of a row with x, relative to their norms, with room for the sums that made x.
pub(crate) const PRODUCT: f64 = 1e-14;

// Multipliers in doubles.

/// Rows nearer to a bound than this, relative to their size, may push.
pub(crate) const AT_BOUND: f64 = 1e-9;
/// Multipliers that leave more of a gradient, relative to its size, miss a row.
pub(crate) const IMBALANCE: f64 = 1e-10;
/// A smaller multiplier, relative to the size of its level, says nothing: twice what the check calls rounding.
pub(crate) const TELLING: f64 = 2.0 * MULTIPLIER;
/// Multipliers this many times larger than a gradient may drown others in rounding.
pub(crate) const LARGE: f64 = 1e6;
/// Rows that depend on each other but for this part may balance a gradient together, with large multipliers:
/// what is tried, one after the other.
pub(crate) const DEPENDENT_ROWS: [f64; 2] = [1e-10, 1e-12];
/// Of a gradient of size one, a smaller multiplier is none.
pub(crate) const NO_MULTIPLIER: f64 = 1e-12;

// Refinement in double-double numbers.

/// Forces of a level that differ by more are beyond multipliers in doubles: what the largest leaves as
/// rounding is then more than 1e-10 of the smallest.
pub(crate) const SPREAD: f64 = 1e6;
/// Of the terms of a row, how far from its bound it may be at x to be tried there.
pub(crate) const NEAR: f64 = 1e-11;
/// Of a row, how much must be independent of others to be brought to its bound with them.
pub(crate) const INDEPENDENT: f64 = 1e-6;
/// A row depends on others when they leave less than this part of it. Its entries are known to 1e-16 of the
/// row, and so the direction of what is left to six digits.
pub(crate) const DEPENDENT: f64 = 1e-10;
/// Of the terms of a hard row, what may be missing where hard rows agree but for their rounding.
pub(crate) const FEASIBLE: f64 = 1e-9;
/// Of a row, less is rounding of its data, even where it stands in the way.
pub(crate) const NOTHING: f64 = 1e-12;
/// Of the terms of a sum, what double-double arithmetic may leave of zero: 1e-32 an operation, with room
/// for a thousand of them.
pub(crate) const SUM: f64 = 1e-29;
/// Of the longest vector, a shorter step is rounding.
pub(crate) const NO_STEP: f64 = 1e-26;
/// Where forces differ much, a step shorter than this is rounding too if it is no shorter than half of the
/// one before.
pub(crate) const FAINT_STEP: f64 = 1e-20;
/// Of their own diagonal entries, pivots of a Hessian below this are zero.
pub(crate) const NO_PIVOT: f64 = 1e-12;
/// Of the gradient, what outside the range of the Hessian is rounding.
pub(crate) const OUTSIDE: f64 = 1e-9;
/// Iterations, in numbers of rows, after which a search is given up.
pub(crate) const EFFORT: usize = 8;
