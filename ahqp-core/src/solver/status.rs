//! How a solve ended.

use std::fmt;

use crate::problem::ids::LevelId;

/// How a solve ended.
///
/// Where a budget ran out, all levels above the one named are at their optimum, all their
/// constraints hold, and the levels from it down are as good as they got. The next warm solve goes
/// on from there. No level stands for the choice of least norm behind the last.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Status {
    /// Every level is at its optimum.
    Solved,
    /// The iterations ran out.
    IterationLimit {
        /// The level in which they did.
        level: Option<LevelId>,
    },
    /// The time ran out.
    TimeLimit {
        /// The level in which it did.
        level: Option<LevelId>,
    },
}

impl Status {
    /// The same ending where levels have other ids.
    pub(crate) fn renamed(self, rename: impl Fn(LevelId) -> LevelId) -> Self {
        match self {
            Self::Solved => self,
            Self::IterationLimit { level } => Self::IterationLimit { level: level.map(rename) },
            Self::TimeLimit { level } => Self::TimeLimit { level: level.map(rename) },
        }
    }

    /// The same ending behind all levels.
    pub(crate) fn behind_all_levels(self) -> Self {
        match self {
            Self::Solved => self,
            Self::IterationLimit { .. } => Self::IterationLimit { level: None },
            Self::TimeLimit { .. } => Self::TimeLimit { level: None },
        }
    }
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
