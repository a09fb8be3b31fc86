//! Endings of a solve.

use std::fmt;

use crate::problem::ids::LevelId;

/// Ending of a solve.
///
/// If a budget ran out, all levels above the named one are at their optimum, and all their
/// constraints hold. The levels from the named one on are as good as the solve made them. The next
/// warm solve continues from there. A level of `None` stands for the choice of least norm after the
/// last level.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Status {
    /// Every level is at its optimum.
    Solved,
    /// The iterations ran out.
    IterationLimit {
        /// The level at which the iterations ran out.
        level: Option<LevelId>,
    },
    /// The time ran out.
    TimeLimit {
        /// The level at which the time ran out.
        level: Option<LevelId>,
    },
}

impl fmt::Display for Status {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (what, level) = match self {
            Self::Solved => return formatter.write_str("every level is at its optimum"),
            Self::IterationLimit { level } => ("iterations", level),
            Self::TimeLimit { level } => ("time", level),
        };
        match level {
            Some(level) => write!(formatter, "the {what} ran out in {level}"),
            None => write!(formatter, "the {what} ran out in the choice of least norm"),
        }
    }
}
