//! Tolerances by which a certificate is found and checked, each with its reason.
//!
//! They are independent of the solver's tolerances for rounding and dependence.

// The check.

/// Smallest violation that counts, relative to the numbers around it.
pub(crate) const VIOLATION: f64 = 1e-9;
/// Smallest multiplier that counts, relative to the gradient of its level.
pub(crate) const MULTIPLIER: f64 = 1e-13;
/// Rounding of the product of a row and x, relative to their norms, with a margin for the sums that
/// made x.
pub(crate) const PRODUCT: f64 = 1e-14;

// Multipliers in doubles.

/// Rows nearer to a bound than this, relative to their size, may have multipliers.
pub(crate) const AT_BOUND: f64 = 1e-9;
/// Multipliers that leave more than this part of a gradient miss a row.
pub(crate) const IMBALANCE: f64 = 1e-10;
/// Smallest multiplier that is informative, relative to the size of its level: twice the rounding
/// of the check.
pub(crate) const TELLING: f64 = 2.0 * MULTIPLIER;
/// Multipliers this many times larger than a gradient may hide others in rounding.
pub(crate) const LARGE: f64 = 1e6;
/// Thresholds of dependence that are tried one after the other. Nearly dependent rows may balance a
/// gradient together, with large multipliers.
pub(crate) const DEPENDENT_ROWS: [f64; 2] = [1e-10, 1e-12];
/// Smallest multiplier that counts, for a gradient of size one.
pub(crate) const NO_MULTIPLIER: f64 = 1e-12;

// Refinement in double-double numbers.

/// Largest ratio of the forces of a level for which multipliers in doubles suffice. Beyond it the
/// rounding of the largest force exceeds 1e-10 of the smallest.
pub(crate) const SCALE_DISPARITY: f64 = 1e6;
/// Largest distance of a row from its bound at x, relative to the row's terms, for which the bound
/// is tried.
pub(crate) const NEAR: f64 = 1e-11;
/// Smallest part of a row that must be independent of others, so that the row is brought to its
/// bound with them.
pub(crate) const INDEPENDENT: f64 = 1e-6;
/// A row depends on others if they leave less than this part of it. Its entries are known to 1e-16
/// of the row, so the direction of the remainder is known to six digits.
pub(crate) const DEPENDENT: f64 = 1e-10;
/// Largest violation of a hard row, relative to its terms, where hard rows agree except for
/// rounding.
pub(crate) const FEASIBLE: f64 = 1e-9;
/// Smallest part of a row that exceeds the rounding of its data, even where it blocks a step.
pub(crate) const NOTHING: f64 = 1e-12;
/// Largest remainder of a sum that is zero in double-double arithmetic, relative to its terms:
/// 1e-32 for an operation, with a margin for a thousand of them.
pub(crate) const SUM: f64 = 1e-29;
/// Shortest step that exceeds rounding, relative to the longest vector.
pub(crate) const NO_STEP: f64 = 1e-26;
/// Where forces differ much, a step shorter than this is rounding too if it is at least half as
/// long as the step before.
pub(crate) const SHORT_STEP: f64 = 1e-20;
/// Pivots of a Hessian below this part of their diagonal entry are zero.
pub(crate) const NO_PIVOT: f64 = 1e-12;
/// Part of the gradient outside the range of the Hessian that is rounding.
pub(crate) const OUTSIDE: f64 = 1e-9;
/// Largest number of iterations of a search, as a multiple of the number of rows.
pub(crate) const EFFORT: usize = 8;
