//! Thresholds of the dependence of rows.

use crate::solver::tolerances::{CLEAR, NEAR_THRESHOLD, NOTHING};

/// Parts of a row, relative to the row, that count as independent of earlier rows.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RankTolerances {
    /// A row of an objective depends on earlier rows if they leave less than this. No row blocks a
    /// step along which it changes by less, up to a limit.
    pub(crate) dependent: f64,
    /// A hard row, which must hold, depends on earlier rows if they leave less than this, which is
    /// rounding.
    pub(super) nothing: f64,
    /// A row may count as dependent if other bounds are active and they leave less than this.
    pub(crate) near_threshold: f64,
    /// A row is independent beyond doubt if they leave more than this.
    pub(super) clear: f64,
}

impl RankTolerances {
    pub(crate) fn new(rank_tolerance: f64) -> Self {
        Self {
            dependent: rank_tolerance,
            nothing: NOTHING.min(rank_tolerance),
            near_threshold: NEAR_THRESHOLD * rank_tolerance,
            clear: CLEAR * rank_tolerance,
        }
    }
}
