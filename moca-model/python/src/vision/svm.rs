//! Linear support vector machines.

use std::path::PathBuf;

use numpy::ndarray::{Array1, Array2, Axis, Ix2};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use vision_models::{Bias, ClassWeights, Loss, SvmSettings};

use super::arrays::floats;
use crate::arrays::{Matrix, vector};
use crate::ergo::keywords::word;
use crate::failure::{Failure, Result, check_file};

/// A linear support vector machine. Two classes have one plane, whose positive side is the second. More classes have a
/// plane each, and the largest decision wins.
///
/// `LinearSvm(classes, weights, biases)` has given planes; `LinearSvm.train` finds them.
///
/// Parameters
/// ----------
/// classes : sequence of str
/// weights : array_like, shape (planes, features)
/// biases : array_like, shape (planes,)
///
/// >>> from ahqp.vision import LinearSvm
/// >>> samples = [[0.0, 1.0], [0.5, 2.0], [3.0, 1.0], [4.0, 0.5]]
/// >>> svm, training = LinearSvm.train(samples, [0, 0, 1, 1], "smooth drilled".split())
/// >>> svm.classify([[0.2, 1.5], [5.0, 1.0]]).tolist(), training[0].converged
/// ([0, 1], True)
#[pyclass(frozen, eq, module = "ahqp.vision")]
#[derive(PartialEq)]
pub(crate) struct LinearSvm(vision_models::LinearSvm);

#[pymethods]
impl LinearSvm {
    #[new]
    fn new(
        classes: Vec<String>,
        weights: &Bound<'_, PyAny>,
        biases: &Bound<'_, PyAny>,
    ) -> Result<Self> {
        let weights = Matrix::read("weights", weights)?.to_nalgebra();
        let weights = Array2::from_shape_fn(weights.shape(), |index| weights[index]);
        let biases = Array1::from(vector("biases", biases)?.as_array().to_vec());
        Ok(Self(vision_models::LinearSvm::new(classes, weights, biases)?))
    }

    /// Trains a machine.
    ///
    /// Parameters
    /// ----------
    /// samples : array_like, shape (N, features)
    /// labels : array_like of int, shape (N,)
    ///     The class of each sample, from 0.
    /// classes : sequence of str
    ///     Names of the classes.
    /// loss : str
    ///     "squared_hinge" or "hinge": the penalty of a margin that is too small.
    /// cost : float
    ///     C, the weight of the penalty beside the margin.
    /// bias_scaling : float, optional
    ///     The bias costs as the weight of a further feature of this value, as in liblinear. It costs nothing if not given.
    /// class_weights : "balanced" or array_like, (classes,), optional
    ///     Factors of the cost. "balanced" gives every class the same weight in total.
    /// tolerance : float
    ///     Relative duality gap at which the training ends.
    /// max_iterations : int
    ///     Largest number of Newton steps.
    ///
    /// Returns
    /// -------
    /// (LinearSvm, list of Training)
    ///     The machine, and how the training of each plane ended.
    #[staticmethod]
    #[pyo3(signature = (samples, labels, classes, *, loss="squared_hinge", cost=1.0, bias_scaling=None, class_weights=None,
        tolerance=1e-9, max_iterations=2000))]
    #[allow(clippy::too_many_arguments)] // keywords of Python
    fn train(
        py: Python<'_>,
        samples: &Bound<'_, PyAny>,
        labels: &Bound<'_, PyAny>,
        classes: Vec<String>,
        loss: &str,
        cost: f64,
        bias_scaling: Option<f64>,
        class_weights: Option<&Bound<'_, PyAny>>,
        tolerance: f64,
        max_iterations: usize,
    ) -> Result<(Self, Vec<Training>)> {
        let samples = floats::<Ix2>("samples", samples, "(N, features)")?;
        let labels = read_labels(labels)?;
        let losses = [("squared_hinge", Loss::SquaredHinge), ("hinge", Loss::Hinge)];
        let settings = SvmSettings {
            loss: word("loss", loss, &losses)?,
            bias: bias_scaling.map_or(Bias::Free, |scaling| Bias::Regularised { scaling }),
            cost,
            class_weights: read_weights(class_weights)?,
            tolerance,
            max_iterations,
        };
        let (machine, trainings) = py.detach(|| {
            vision_models::LinearSvm::train(samples.view(), &labels, classes, &settings)
        })?;
        Ok((Self(machine), trainings.into_iter().map(Training).collect()))
    }

    /// Reads a machine from a file that `save` wrote.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> Result<Self> {
        check_file(&path)?;
        let read = py.detach(|| vision_models::LinearSvm::read(&path));
        Ok(Self(read.map_err(|error| super::weights::in_file(&path, error))?))
    }

    /// Writes the machine to a file of text, every number exactly.
    fn save(&self, path: PathBuf) -> Result<()> {
        Ok(std::fs::write(path, self.0.to_string())?)
    }

    /// The class of each sample: (N, features) gives (N,), indices into `classes`.
    fn classify<'py>(
        &self,
        py: Python<'py>,
        samples: &Bound<'py, PyAny>,
    ) -> Result<Bound<'py, PyArray1<usize>>> {
        let samples = floats::<Ix2>("samples", samples, "(N, features)")?;
        let classes = samples.outer_iter().map(|sample| self.0.classify(sample));
        let classes = classes.collect::<std::result::Result<Vec<_>, _>>()?;
        Ok(PyArray1::from_vec(py, classes))
    }

    /// Decision values wᵀx + b of samples, (N, features), for each plane: (N, planes).
    fn decide<'py>(
        &self,
        py: Python<'py>,
        samples: &Bound<'py, PyAny>,
    ) -> Result<Bound<'py, PyArray2<f64>>> {
        let samples = floats::<Ix2>("samples", samples, "(N, features)")?;
        let mut decisions = Array2::zeros((samples.nrows(), self.0.biases().len()));
        for (mut row, sample) in decisions.outer_iter_mut().zip(samples.axis_iter(Axis(0))) {
            row.assign(&self.0.decide(sample)?);
        }
        Ok(PyArray2::from_owned_array(py, decisions))
    }

    /// Names of the classes.
    #[getter]
    fn classes(&self) -> Vec<String> {
        self.0.classes().to_vec()
    }

    /// Normal vectors of the planes, (planes, features).
    #[getter]
    fn weights<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        PyArray2::from_owned_array(py, self.0.weights().to_owned())
    }

    /// Biases of the planes, (planes,).
    #[getter]
    fn biases<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_owned_array(py, self.0.biases().to_owned())
    }

    fn __repr__(&self) -> String {
        let features = self.0.weights().ncols();
        format!("<ahqp.vision.LinearSvm: {} classes, {features} features>", self.0.classes().len())
    }
}

fn read_labels(labels: &Bound<'_, PyAny>) -> Result<Vec<usize>> {
    let labels = vector("labels", labels)?;
    let label = |label: &f64| {
        if label.fract() == 0.0 && (0.0..1e9).contains(label) {
            // The value is whole, and not negative.
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            return Ok(*label as usize);
        }
        Err(Failure::value(format!("a label is {label}; labels are indices into classes, from 0")))
    };
    labels.as_array().iter().map(label).collect()
}

fn read_weights(weights: Option<&Bound<'_, PyAny>>) -> Result<ClassWeights> {
    let Some(weights) = weights else { return Ok(ClassWeights::Equal) };
    match weights.extract::<&str>() {
        Ok("balanced") => Ok(ClassWeights::Balanced),
        Ok(other) => Err(Failure::value(format!(
            "class_weights is \"{other}\"; give \"balanced\", or a weight for each class"
        ))),
        Err(_) => Ok(ClassWeights::Given(vector("class_weights", weights)?.as_array().to_vec())),
    }
}

/// How the training of a plane ended.
#[pyclass(frozen, module = "ahqp.vision")]
pub(crate) struct Training(vision_models::Training);

#[pymethods]
impl Training {
    /// True if the duality gap is within the tolerance.
    #[getter]
    fn converged(&self) -> bool {
        self.0.converged
    }

    /// The number of Newton steps.
    #[getter]
    fn iterations(&self) -> usize {
        self.0.iterations
    }

    /// Objective of the plane: ½ wᵀw and the penalties.
    #[getter]
    fn objective(&self) -> f64 {
        self.0.objective
    }

    /// Relative duality gap: how far the objective may be above the least one.
    #[getter]
    fn gap(&self) -> f64 {
        self.0.gap()
    }
}
