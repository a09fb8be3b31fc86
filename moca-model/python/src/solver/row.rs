//! Rows of a problem.

use ahqp_core::ConstraintSource;
use pyo3::prelude::*;

/// A row of a problem: the bounds of a variable, a hard constraint, or a row of an objective.
///
/// `str(row)` describes it, with the given names of levels and variables.
#[pyclass(frozen, eq, hash, module = "ahqp")]
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct Row {
    source: ConstraintSource,
    text: String,
}

impl Row {
    pub(crate) fn new(hierarchy: &ahqp_core::Hierarchy, source: ConstraintSource) -> Self {
        Self { source, text: hierarchy.describe(source).to_string() }
    }
}

#[pymethods]
impl Row {
    /// "bound", "constraint" or "objective".
    #[getter]
    fn kind(&self) -> &'static str {
        match self.source {
            ConstraintSource::Bound { .. } => "bound",
            ConstraintSource::Constraint { .. } => "constraint",
            _ => "objective",
        }
    }

    /// The number of its level; None for the bounds of a variable.
    #[getter]
    fn level(&self) -> Option<usize> {
        self.source.level().map(ahqp_core::LevelId::index)
    }

    /// The row within the level, or the variable.
    #[getter]
    fn index(&self) -> usize {
        match self.source {
            ConstraintSource::Bound { variable } => variable,
            ConstraintSource::Constraint { row, .. } | ConstraintSource::Objective { row, .. } => {
                row
            }
            _ => usize::MAX,
        }
    }

    fn __str__(&self) -> &str {
        &self.text
    }

    fn __repr__(&self) -> String {
        format!("<ahqp.Row: {}>", self.text)
    }
}
