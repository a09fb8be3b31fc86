//! Proofs of optimality.

use pyo3::prelude::*;

use super::hierarchy::Hierarchy;
use super::row::Row;
use super::slice_of;
use crate::failure::Result;

/// Multipliers that prove a solution optimal; `Solver.certificate` makes one.
#[pyclass(frozen, module = "ahqp")]
pub(crate) struct Certificate {
    pub(crate) inner: ahqp_core::Certificate,
    /// Problem with the names of rows.
    pub(crate) problem: ahqp_core::Hierarchy,
}

impl Certificate {
    /// Returns the multipliers of all levels, and of the choice of least norm.
    pub(crate) fn all(&self) -> Vec<Vec<(Row, f64)>> {
        (0..=self.problem.levels().len()).map(|level| self.multipliers(level)).collect()
    }
}

#[pymethods]
impl Certificate {
    /// The nonzero multipliers of a level, counted from 0. The number of levels stands for the choice of least norm.
    /// Multipliers are positive at an upper bound. Rows of a quadratic objective are those of its Hessian.
    fn multipliers(&self, level: usize) -> Vec<(Row, f64)> {
        let found = self.inner.multipliers(level).iter();
        found.map(|&(source, multiplier)| (Row::new(&self.problem, source), multiplier)).collect()
    }

    /// The active set: rows and bounds that are held at a bound, and violated rows of objectives.
    #[getter]
    fn active(&self) -> Vec<Row> {
        super::rows(&self.problem, self.inner.active())
    }

    /// Checks that x, shape (n,), is optimal, from the data and the multipliers alone.
    fn residuals(&self, hierarchy: &Hierarchy, x: &Bound<'_, PyAny>) -> Result<Residuals> {
        let problem = hierarchy.0.lock()?;
        Ok(Residuals(slice_of("x", x, |x| self.inner.residuals(&problem.hierarchy, x))??))
    }
}

/// Residuals of the optimality conditions at a point with its multipliers. Each is the worst of all levels, relative to
/// the numbers in the problem.
#[pyclass(frozen, module = "ahqp")]
pub(crate) struct Residuals(ahqp_core::CertificateResiduals);

#[pymethods]
impl Residuals {
    /// Part of a level's gradient that the multipliers do not cancel.
    #[getter]
    fn stationarity(&self) -> f64 {
        self.0.stationarity
    }

    /// Violation of a bound or hard constraint.
    #[getter]
    fn feasibility(&self) -> f64 {
        self.0.feasibility
    }

    /// Distance of an inequality from its bound, where its multiplier is not zero.
    #[getter]
    fn complementarity(&self) -> f64 {
        self.0.complementarity
    }

    /// Size of a multiplier with the wrong sign.
    #[getter]
    fn sign(&self) -> f64 {
        self.0.sign
    }

    /// Distance from x to the optimum, if the multipliers alone do not prove it; else None.
    #[getter]
    fn distance(&self) -> Option<f64> {
        self.0.distance
    }

    /// The violation, or the distance to the optimum if that is larger. If there is no distance, the largest residual.
    #[getter]
    fn worst(&self) -> f64 {
        self.0.worst()
    }

    fn __repr__(&self) -> String {
        format!("<ahqp.Residuals: worst {:e}>", self.0.worst())
    }
}
