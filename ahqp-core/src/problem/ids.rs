//! Identifiers of levels.

use std::fmt;

/// Identifier of a level of a [`Hierarchy`](crate::Hierarchy).
///
/// [`Hierarchy::push`](crate::Hierarchy::push) returns it. Levels are numbered from 0 in the order
/// of priority.
///
/// ```
/// use ahqp_core::{Hierarchy, Level, Rows};
/// use nalgebra::{dmatrix, dvector};
///
/// let mut hierarchy = Hierarchy::new(2)?;
/// let sum = Rows::equalities(&dmatrix![1.0, 1.0], &dvector![2.0])?;
/// let sum = hierarchy.push(Level::least_squares(sum))?;
/// hierarchy.rows_mut(sum)?.set_targets(&[3.0])?;
/// assert_eq!((sum.index(), sum.to_string()), (0, "level 0".into()));
/// # Ok::<(), ahqp_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct LevelId(usize);

impl LevelId {
    pub(crate) fn new(index: usize) -> Self {
        Self(index)
    }

    /// Number of levels above. This is the index in [`levels`](crate::Hierarchy::levels).
    pub fn index(self) -> usize {
        self.0
    }
}

impl fmt::Display for LevelId {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "level {}", self.0)
    }
}
