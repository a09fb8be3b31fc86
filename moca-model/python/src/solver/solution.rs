//! What a solve gives.

use std::time::Duration;

use ahqp_core::Status;
use numpy::PyArray1;
use pyo3::prelude::*;

use super::Solver;
use super::hierarchy::Hierarchy;
use super::row::Row;
use crate::arrays::to_vector;
use crate::failure::{Failure, Result};

/// What a solve gave.
#[pyclass(frozen, module = "ahqp")]
pub(crate) struct Solution {
    pub(crate) found: ahqp_core::Solution,
    pub(crate) time: Duration,
    pub(crate) hierarchy: Py<Hierarchy>,
    /// The hierarchy's count of changes.
    pub(crate) changes: u64,
    pub(crate) solver: Py<Solver>,
    /// The solver's count of solves.
    pub(crate) solve: u64,
}

#[pymethods]
impl Solution {
    /// The variables at the optimum, shape (n,). Raises `UnfinishedError` unless `status` is "solved".
    #[getter]
    fn x<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray1<f64>>> {
        Ok(to_vector(py, self.found.optimum()?))
    }

    /// The variables as far as the solve came, shape (n,).
    #[getter]
    fn best<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        to_vector(py, self.found.best())
    }

    /// "solved", "iteration_limit" or "time_limit".
    #[getter]
    fn status(&self) -> &'static str {
        name(self.found.status())
    }

    /// Iterations spent: rounds of repair and steps of searches, over all levels.
    #[getter]
    fn iterations(&self) -> usize {
        self.found.iterations()
    }

    /// How far each level is from what it asks for, shape (levels,): √(Σ wᵢ dᵢ²), dᵢ being the distance
    /// of row i to its range; zero for levels that only constrain or minimise a quadratic. Found when
    /// asked for; raises `ValueError` if the hierarchy has changed since.
    #[getter]
    fn violations<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray1<f64>>> {
        let problem = self.hierarchy.get().0.lock()?;
        if problem.changes != self.changes {
            let text = "the hierarchy has changed; take violations before it does";
            return Err(Failure::value(text));
        }
        let levels = problem.hierarchy.levels().iter();
        let violations = levels.map(|level| Ok(level.violation(self.found.best())?));
        Ok(to_vector(py, &violations.collect::<Result<Vec<_>>>()?))
    }

    /// What the solve itself took, without the way from Python and back [s].
    #[getter]
    fn time(&self) -> f64 {
        self.time.as_secs_f64()
    }

    /// The multipliers that are not zero, a list for each level and one more for the choice of least
    /// norm: pairs of a `Row` and a number, positive at an upper bound. Found when asked for.
    ///
    /// Raises `Error` if the solver has solved again, or the hierarchy has changed.
    #[getter]
    fn multipliers(&self, py: Python<'_>) -> Result<Vec<Vec<(Row, f64)>>> {
        let solver = self.solver.get();
        if solver.0.lock()?.solves != self.solve {
            let text = "the solver has solved again; take multipliers before the next solve";
            return Err(Failure::value(text));
        }
        Ok(solver.certificate(py, self.hierarchy.get())?.all())
    }

    fn __repr__(&self) -> String {
        let (status, iterations) = (self.status(), self.iterations());
        let count = self.found.best().len();
        format!("<ahqp.Solution: {status}, {count} variables, {iterations} iterations>")
    }
}

/// An ending in a word.
pub(crate) fn name(status: Status) -> &'static str {
    match status {
        Status::Solved => "solved",
        Status::TimeLimit { .. } => "time_limit",
        _ => "iteration_limit",
    }
}
