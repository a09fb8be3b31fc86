//! Sources of rows in a problem, and their names.

use std::fmt;
use std::sync::Arc;

use crate::problem::ids::LevelId;

/// Source of a row of the problem.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum ConstraintSource {
    /// The bounds of a variable.
    Bound {
        /// The variable.
        variable: usize,
    },
    /// A hard constraint of a level.
    Constraint {
        /// The level.
        level: LevelId,
        /// Index of the row in the level's constraints.
        row: usize,
    },
    /// A row of a level's objective.
    Objective {
        /// The level.
        level: LevelId,
        /// Index of the row in the level's objective.
        row: usize,
    },
}

impl ConstraintSource {
    /// Returns the level, unless it is a bound.
    pub fn level(self) -> Option<LevelId> {
        match self {
            Self::Bound { .. } => None,
            Self::Constraint { level, .. } | Self::Objective { level, .. } => Some(level),
        }
    }
}

impl fmt::Display for ConstraintSource {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        Label { source: *self, names: Names::default() }.fmt(formatter)
    }
}

/// Names of a level and of one of its rows, or of a variable.
///
/// Errors contain them, so that they are readable without the problem. Cloning does not allocate.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Names {
    /// Name of the level.
    pub level: Option<Arc<str>>,
    /// Name of the row, or of the variable whose bounds it is.
    pub row: Option<Arc<str>>,
}

impl Names {
    /// Describes a level as "level 3" with its name, or as "the level" if its id is not known.
    pub(crate) fn label_of_level(&self, level: impl Into<Option<LevelId>>) -> LevelLabel<'_> {
        LevelLabel { level: level.into(), name: Quoted(self.level.as_deref()) }
    }

    /// Describes a row as "constraint row 2 of level 3", with the names.
    pub(crate) fn label(&self, source: ConstraintSource) -> Label {
        Label { source, names: self.clone() }
    }
}

/// Description of a row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Label {
    source: ConstraintSource,
    names: Names,
}

impl fmt::Display for Label {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (kind, level, row) = match self.source {
            ConstraintSource::Bound { variable } => ("the bounds of variable", None, variable),
            ConstraintSource::Constraint { level, row } => ("constraint row", Some(level), row),
            ConstraintSource::Objective { level, row } => ("objective row", Some(level), row),
        };
        write!(formatter, "{kind} {row}{}", Quoted(self.names.row.as_deref()))?;
        match level {
            Some(level) => write!(formatter, " of {}", self.names.label_of_level(level)),
            None => Ok(()),
        }
    }
}

/// Description of a level.
pub(crate) struct LevelLabel<'a> {
    level: Option<LevelId>,
    name: Quoted<'a>,
}

impl fmt::Display for LevelLabel<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.level {
            Some(level) => write!(formatter, "{level}{}", self.name),
            None => write!(formatter, "the level{}", self.name),
        }
    }
}

/// A space and a name in quotes, or nothing.
struct Quoted<'a>(Option<&'a str>);

impl fmt::Display for Quoted<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.map_or(Ok(()), |name| write!(formatter, " \"{name}\""))
    }
}
