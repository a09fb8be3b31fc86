//! From where on a row depends on those before it.

use crate::solver::tolerances::{CLEAR, FAINT, NOTHING};

/// What of a row counts as a part of its own, relative to the row.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RankTolerances {
    /// Less than this of a row of an objective depends on the rows before it.
    pub(super) dependent: f64,
    /// The same of hard rows, which must hold: rounding.
    pub(super) nothing: f64,
    /// Less than this of a row may be taken for dependent when other bounds are active.
    pub(crate) faint: f64,
    /// More than this is beyond doubt.
    pub(super) clear: f64,
}

impl RankTolerances {
    pub(crate) fn new(rank_tolerance: f64) -> Self {
        Self {
            dependent: rank_tolerance,
            nothing: NOTHING.min(rank_tolerance),
            faint: FAINT * rank_tolerance,
            clear: CLEAR * rank_tolerance,
        }
    }
}
