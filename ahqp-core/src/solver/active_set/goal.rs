//! What a search within one level minimises.

use std::ops::Range;

/// What a search minimises.
#[derive(Debug, Clone)]
pub(crate) enum Goal {
    /// The violation of these rows, which the last group holds, and the linear term of their level.
    Rows(Range<usize>),
    /// ‖x‖.
    Norm,
}

impl Goal {
    /// Returns true if the violation of row `id` is minimised.
    pub(super) fn has_row(&self, id: usize) -> bool {
        matches!(self, Self::Rows(rows) if rows.contains(&id))
    }
}
