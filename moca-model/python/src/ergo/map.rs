//! Maps of a person's ergonomics, and quadratics fitted to them.

use std::path::PathBuf;

use ahqp_core::CoefficientMatrix;
use ergo_map::{FitOptions, MapOptions, Region};
use nalgebra::Vector3;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use super::keywords::{mode, side, side_name};
use super::person::Person;
use super::posture::Posture;
use crate::arrays::{Matrix, numbers, to_array, to_vector};
use crate::failure::{Failure, Result};

type Vector<'py> = Bound<'py, PyArray1<f64>>;

/// Scores and postures over the volume that a person's hand can reach.
///
/// `ErgonomicsMap(person, *, side="right", spacing=0.05, region=None, mode="graded")`
///
/// Parameters
/// ----------
/// person : Person
/// side : str
///     The working hand, "left" or "right".
/// spacing : float
///     Distance between nodes, in statures.
/// region : pair of array_like, (3,), optional
///     The two corners of the region, in the person's frame [m]; everything within reach if not given.
/// mode : str
///     "graded" or "faithful"; see `ergonomics_score`.
///
/// Positions are in the person's frame [m]: origin on the floor below the pelvis, x forward, y left, z
/// up. Building releases the interpreter's lock and uses all cores.
#[pyclass(frozen, module = "ahqp.ergo")]
pub(crate) struct ErgonomicsMap(pub(crate) ergo_map::ErgonomicsMap);

#[pymethods]
impl ErgonomicsMap {
    #[new]
    #[pyo3(signature = (person, *, side="right", spacing=0.05, region=None, mode="graded"))]
    fn new(
        py: Python<'_>,
        person: &Person,
        side: &str,
        spacing: f64,
        region: Option<(Bound<'_, PyAny>, Bound<'_, PyAny>)>,
        mode: &str,
    ) -> Result<Self> {
        let options = MapOptions {
            side: self::side(side)?,
            spacing,
            region: read_region(region)?,
            mode: self::mode(mode)?,
            ..MapOptions::default()
        };
        Ok(Self(py.detach(|| ergo_map::ErgonomicsMap::build(&person.0, &options, None))?))
    }

    /// Reads a map from a file that `save` wrote.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> Result<Self> {
        Ok(Self(py.detach(|| ergo_map::ErgonomicsMap::load(path))?))
    }

    /// Writes the map to a file.
    fn save(&self, py: Python<'_>, path: PathBuf) -> Result<()> {
        Ok(py.detach(|| self.0.save(path))?)
    }

    /// Stature of the person [m].
    #[getter]
    fn stature(&self) -> f64 {
        self.0.stature()
    }

    /// The working hand, "left" or "right".
    #[getter]
    fn side(&self) -> &'static str {
        side_name(self.0.side())
    }

    /// The number of nodes that the hand can reach.
    fn __len__(&self) -> usize {
        self.0.len()
    }

    /// The nodes that the hand can reach: positions, (nodes, 3), and scores, (nodes,).
    fn nodes<'py>(&self, py: Python<'py>) -> (Bound<'py, PyArray2<f64>>, Vector<'py>) {
        let nodes: Vec<_> = self.0.nodes().collect();
        let positions =
            nalgebra::DMatrix::from_fn(nodes.len(), 3, |i, axis| nodes[i].position[axis]);
        let scores: Vec<f64> = nodes.iter().map(|node| node.score).collect();
        (to_array(py, &positions), to_vector(py, &scores))
    }

    /// True if the map knows the score at a hand position, (3,).
    fn contains(&self, hand: &Bound<'_, PyAny>) -> Result<bool> {
        Ok(self.0.contains(&point("hand", hand)?))
    }

    /// The score e_s at a hand position, (3,), and its gradient there [1/m], (3,). Raises `Error`
    /// outside the map's domain.
    fn sample<'py>(&self, py: Python<'py>, hand: &Bound<'py, PyAny>) -> Result<(f64, Vector<'py>)> {
        let sample = self.0.sample(&point("hand", hand)?)?;
        Ok((sample.score, to_vector(py, sample.gradient.as_slice())))
    }

    /// The scores at many hand positions, (m, 3); NaN outside the map's domain. Shape (m,).
    fn scores<'py>(&self, py: Python<'py>, hands: &Bound<'py, PyAny>) -> Result<Vector<'py>> {
        let hands = Matrix::read("hands", hands)?;
        let view = hands.view();
        if view.ncols() != 3 {
            let text = format!("hands has {} columns; it must have 3: x, y, z", view.ncols());
            return Err(Failure::value(text));
        }
        let score = |row| {
            let hand = Vector3::from_fn(|axis, _| view.entry(row, axis));
            self.0.sample(&hand).map_or(f64::NAN, |sample| sample.score)
        };
        Ok(to_vector(py, &(0..view.nrows()).map(score).collect::<Vec<_>>()))
    }

    /// The posture for a hand position, (3,), interpolated between the postures of the nodes.
    fn posture(&self, hand: &Bound<'_, PyAny>) -> Result<Posture> {
        Ok(self.0.posture(&point("hand", hand)?)?.posture().into())
    }

    /// The convex quadratic that fits the map best, with its report.
    ///
    /// Parameters
    /// ----------
    /// region : pair of array_like, (3,), optional
    ///     The two corners of the points that count [m]; the work zone if not given.
    /// temperature : float
    ///     T in the weight exp(-(e - min e)/T). A smaller T gives good postures more weight.
    /// min_curvature : float
    ///     Smallest eigenvalue of H [1/m²], positive.
    #[pyo3(signature = (*, region=None, temperature=0.5, min_curvature=1e-3))]
    fn fit(
        &self,
        py: Python<'_>,
        region: Option<(Bound<'_, PyAny>, Bound<'_, PyAny>)>,
        temperature: f64,
        min_curvature: f64,
    ) -> Result<(Quadratic, FitReport)> {
        let options = FitOptions { region: read_region(region)?, temperature, min_curvature };
        let (quadratic, report) = py.detach(|| self.0.fit(&options))?;
        Ok((Quadratic(quadratic), FitReport(report)))
    }

    fn __repr__(&self) -> String {
        let (stature, nodes) = (self.0.stature(), self.0.len());
        format!("<ahqp.ergo.ErgonomicsMap: {stature} m, {} hand, {nodes} nodes>", self.side())
    }
}

fn point(name: &str, value: &Bound<'_, PyAny>) -> Result<Vector3<f64>> {
    Ok(numbers::<3>(name, value)?.into())
}

fn read_region(corners: Option<(Bound<'_, PyAny>, Bound<'_, PyAny>)>) -> Result<Option<Region>> {
    let Some((low, high)) = corners else { return Ok(None) };
    Ok(Some(Region::new(point("region", &low)?, point("region", &high)?)?))
}

/// e(x) = ½ xᵀ H x + gᵀ x + c of a hand position x [m], convex.
#[pyclass(frozen, module = "ahqp.ergo")]
pub(crate) struct Quadratic(pub(crate) ergo_map::ErgonomicsQuadratic);

#[pymethods]
impl Quadratic {
    /// H [1/m²], (3, 3).
    #[getter]
    fn hessian<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        to_array(py, self.0.hessian())
    }

    /// g [1/m], (3,).
    #[getter]
    fn gradient<'py>(&self, py: Python<'py>) -> Vector<'py> {
        to_vector(py, self.0.gradient().as_slice())
    }

    /// c.
    #[getter]
    fn constant(&self) -> f64 {
        self.0.constant()
    }

    /// e(x) at x, (3,).
    fn value(&self, x: &Bound<'_, PyAny>) -> Result<f64> {
        Ok(self.0.value(&point("x", x)?))
    }

    /// Position at which e is smallest, (3,); None where H is singular.
    fn minimiser<'py>(&self, py: Python<'py>) -> Option<Vector<'py>> {
        self.0.minimiser().map(|x| to_vector(py, x.as_slice()))
    }
}

/// Accuracy with which a quadratic approximates the score.
#[pyclass(frozen, module = "ahqp.ergo")]
pub(crate) struct FitReport(ergo_map::FitReport);

#[pymethods]
impl FitReport {
    /// Number of points in the fit.
    #[getter]
    fn samples(&self) -> usize {
        self.0.samples
    }

    /// Coefficient of determination, with equal weights of all points.
    #[getter]
    fn r_squared(&self) -> f64 {
        self.0.r_squared
    }

    /// Root mean square error, with equal weights of all points.
    #[getter]
    fn rmse(&self) -> f64 {
        self.0.rmse
    }

    /// Spearman's rank correlation between quadratic and score.
    #[getter]
    fn spearman(&self) -> f64 {
        self.0.spearman
    }

    /// Eigenvalues of H, ascending [1/m²], (3,).
    #[getter]
    fn eigenvalues<'py>(&self, py: Python<'py>) -> Vector<'py> {
        to_vector(py, self.0.eigenvalues.as_slice())
    }

    /// The quadratic's minimiser within the points' box [m], (3,).
    #[getter]
    fn optimum<'py>(&self, py: Python<'py>) -> Vector<'py> {
        to_vector(py, self.0.optimum.as_slice())
    }

    /// The map's score at the optimum less the map's minimum.
    #[getter]
    fn regret(&self) -> Option<f64> {
        self.0.regret.map(|regret| regret.at_optimum)
    }

    fn __repr__(&self) -> String {
        format!("<ahqp.ergo.FitReport: R² {:.3}, RMSE {:.3}>", self.0.r_squared, self.0.rmse)
    }
}
