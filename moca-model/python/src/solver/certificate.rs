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
    /// For the names of rows.
    pub(crate) problem: ahqp_core::Hierarchy,
}

impl Certificate {
    /// The multipliers of all levels, and of the choice of least norm.
    pub(crate) fn all(&self) -> Vec<Vec<(Row, f64)>> {
        (0..=self.problem.levels().len()).map(|level| self.multipliers(level)).collect()
    }
}

#[pymethods]
impl Certificate {
    /// The multipliers that are not zero of a level, from 0; the number of levels stands for the choice
    /// of least norm. Positive at an upper bound. Rows of a quadratic objective are those of its Hessian.
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

/// How far a point and its multipliers are from proving optimality, each the worst of all levels and
/// relative to the numbers at hand.
#[pyclass(frozen, module = "ahqp")]
pub(crate) struct Residuals(ahqp_core::CertificateResiduals);

#[pymethods]
impl Residuals {
    /// What the multipliers leave of a level's gradient.
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

    /// Size of a multiplier that pushes the wrong way.
    #[getter]
    fn sign(&self) -> f64 {
        self.0.sign
    }

    /// Distance from x to the optimum, where multipliers do not prove enough; else None.
    #[getter]
    fn distance(&self) -> Option<f64> {
        self.0.distance
    }

    /// How far from proved x is.
    #[getter]
    fn worst(&self) -> f64 {
        self.0.worst()
    }

    fn __repr__(&self) -> String {
        format!("<ahqp.Residuals: worst {:e}>", self.0.worst())
    }
}
