//! Goals of a search within one level.

use std::ops::Range;

/// Objective of a search.
#[derive(Debug, Clone)]
pub(crate) enum Goal {
    /// The violation of these rows, which the last group contains, and the linear term of their
    /// level.
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
