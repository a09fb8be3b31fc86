//! Result of a solve.

use std::time::Duration;

use ahqp_core::Status;
use numpy::PyArray1;
use pyo3::prelude::*;

use super::Solver;
use super::hierarchy::Hierarchy;
use super::row::Row;
use crate::arrays::to_vector;
use crate::failure::{Failure, Result};

/// Result of a solve.
#[pyclass(frozen, module = "ahqp")]
pub(crate) struct Solution {
    pub(crate) found: ahqp_core::Solution,
    pub(crate) time: Duration,
    pub(crate) hierarchy: Py<Hierarchy>,
    /// Number of changes of the hierarchy.
    pub(crate) changes: u64,
    pub(crate) solver: Py<Solver>,
    /// Number of solves of the solver.
    pub(crate) solve: u64,
}

#[pymethods]
impl Solution {
    /// The variables at the optimum, shape (n,). Raises `UnfinishedError` unless `status` is "solved".
    #[getter]
    fn x<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray1<f64>>> {
        Ok(to_vector(py, self.found.optimum()?))
    }

    /// The best variables that the solve found, shape (n,).
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

    /// The violation √(Σ wᵢ dᵢ²) of each level, shape (levels,), where dᵢ is the distance of row i to its range. It is
    /// zero for levels that only constrain or minimise a quadratic. It is computed on request. Raises `ValueError` if
    /// the hierarchy has changed since.
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

    /// The time of the solve itself [s], without the way from Python and back.
    #[getter]
    fn time(&self) -> f64 {
        self.time.as_secs_f64()
    }

    /// The nonzero multipliers: a list for each level, and one for the choice of least norm. Each entry is a pair of a
    /// `Row` and a number, which is positive at an upper bound. They are computed on request.
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

/// Returns the name of a status.
pub(crate) fn name(status: Status) -> &'static str {
    match status {
        Status::Solved => "solved",
        Status::TimeLimit { .. } => "time_limit",
        _ => "iteration_limit",
    }
}
