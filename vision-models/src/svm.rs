//! The linear support vector machine over a network's features (paper, Sec. "Two-Class Linear
//! Support Vector Machine").
#![allow(clippy::needless_pass_by_value)] // views are passed by value, as usual with ndarray

mod ascent;
mod cholesky;
mod file;
mod line;
mod newton;
mod problem;
mod settings;
mod smoothing;
mod training;

use ndarray::{Array1, Array2, ArrayView1, ArrayView2, Axis};

pub use settings::{Bias, ClassWeights, Loss, SvmSettings};
pub use training::Training;

use self::{newton::Newton, problem::Problem, training::train};
use crate::error::Error;
use crate::samples::{check_classes, check_finite, check_samples, misfit, not_finite};

/// A linear classifier. Two classes have one plane, whose positive side is the second class. More
/// classes have one plane each against the rest, and the class with the largest decision value
/// wins.
///
/// ```
/// use ndarray::{array, Array2};
/// use vision_models::{LinearSvm, SvmSettings};
///
/// let features: Array2<f32> = array![[0.0, 1.0], [0.5, 2.0], [3.0, 1.0], [4.0, 0.5]];
/// let classes = vec!["smooth".into(), "drilled".into()];
/// let settings = SvmSettings::default();
/// let (svm, training) = LinearSvm::train(features.view(), &[0, 0, 1, 1], classes, &settings)?;
/// assert!(training[0].converged);
/// assert_eq!(svm.classify(features.row(2))?, 1);
///
/// let copy: LinearSvm = svm.to_string().parse()?;
/// assert_eq!(copy, svm);
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct LinearSvm {
    classes: Vec<String>,
    /// One row per plane.
    weights: Array2<f64>,
    biases: Array1<f64>,
}

impl LinearSvm {
    /// Largest number of training samples.
    pub const MAX_SAMPLES: usize = 10_000_000;

    /// Trains on features, samples × features. `labels` are the samples' classes as indices into
    /// `classes`. Also returns how the training of each plane ended.
    ///
    /// # Errors
    /// [`Error::Malformed`] if one of these is wrong:
    /// - There are no samples, too many, or fewer than two classes.
    /// - Labels are missing or out of range.
    /// - A class has no sample, no name or the name of another class.
    /// - The number of class weights is not the number of classes.
    ///
    /// [`Error::Value`] if a feature is not finite or a setting is out of range.
    pub fn train(
        samples: ArrayView2<'_, f32>,
        labels: &[usize],
        classes: Vec<String>,
        settings: &SvmSettings,
    ) -> Result<(Self, Vec<Training>), Error> {
        settings.validate()?;
        check_samples(&samples, labels, &classes, Self::MAX_SAMPLES)?;
        let class_costs = settings.costs(labels, classes.len())?;
        let cost = |&label: &usize| class_costs.get(label).copied().unwrap_or(settings.cost);
        let samples = samples.as_standard_layout();

        // The classes on the positive side of each plane.
        let positives = if classes.len() == 2 { 1..2 } else { 0..classes.len() };
        let mut weights = Array2::zeros((positives.len(), samples.ncols()));
        let mut biases = Array1::zeros(positives.len());
        let mut trainings = Vec::with_capacity(positives.len());
        let mut newton = Newton::default();
        for ((mut row, bias), class) in weights.outer_iter_mut().zip(&mut biases).zip(positives) {
            let side = |&label: &usize| if label == class { 1.0 } else { -1.0 };
            let problem = Problem {
                samples: samples.view(),
                sides: labels.iter().map(side).collect(),
                costs: labels.iter().map(cost).collect(),
                loss: settings.loss,
                bias: settings.bias,
            };
            let (plane, training) =
                train(&problem, &mut newton, settings.tolerance, settings.max_iterations);
            row.assign(&plane.weights);
            *bias = plane.bias;
            trainings.push(training);
        }
        Ok((Self { classes, weights, biases }, trainings))
    }

    /// Creates a machine from given planes, one row of `weights` each.
    ///
    /// # Errors
    /// - [`Error::Malformed`] if the numbers of classes, planes and biases differ, or class names
    ///   are empty or equal.
    /// - [`Error::Value`] if a weight or bias is not finite.
    pub fn new(
        classes: Vec<String>,
        weights: Array2<f64>,
        biases: Array1<f64>,
    ) -> Result<Self, Error> {
        check_classes(&classes)?;
        let planes = if classes.len() == 2 { 1 } else { classes.len() };
        if weights.nrows() != planes || biases.len() != planes || weights.ncols() == 0 {
            return Err(misfit(format!(
                "{} classes have {} rows of {} weights and {} biases: give {planes} of each",
                classes.len(),
                weights.nrows(),
                weights.ncols(),
                biases.len()
            )));
        }
        let all = weights.indexed_iter().map(|((row, column), &value)| (row, column, value));
        let biased = biases.iter().enumerate().map(|(row, &value)| (row, weights.ncols(), value));
        if let Some((row, column, value)) = all.chain(biased).find(|(.., value)| !value.is_finite())
        {
            return Err(not_finite(row, column, value));
        }
        let weights = weights.as_standard_layout().into_owned();
        Ok(Self { classes, weights, biases })
    }

    /// Returns the names of the classes.
    pub fn classes(&self) -> &[String] {
        &self.classes
    }

    /// Returns the planes' normal vectors, planes × features.
    pub fn weights(&self) -> ArrayView2<'_, f64> {
        self.weights.view()
    }

    /// Returns the planes' biases.
    pub fn biases(&self) -> ArrayView1<'_, f64> {
        self.biases.view()
    }

    /// Returns f(x) = wᵀx + b of each plane: the distance from it times |w|, positive on its
    /// positive side.
    ///
    /// # Errors
    /// - [`Error::Malformed`] if the number of features differs from the training's.
    /// - [`Error::Value`] if a feature is not finite.
    pub fn decide(&self, features: ArrayView1<'_, f32>) -> Result<Array1<f64>, Error> {
        if features.len() != self.weights.ncols() {
            return Err(misfit(format!(
                "{} features were given to a machine that was trained with {}",
                features.len(),
                self.weights.ncols()
            )));
        }
        check_finite(&features.insert_axis(Axis(0)))?;
        Ok(self.weights.dot(&features.mapv(f64::from)) + &self.biases)
    }

    /// Returns the index of the class.
    ///
    /// # Errors
    /// Those of [`Self::decide`].
    pub fn classify(&self, features: ArrayView1<'_, f32>) -> Result<usize, Error> {
        let decisions = self.decide(features)?;
        if let [decision] = decisions.as_slice().unwrap_or_default() {
            return Ok(usize::from(*decision > 0.0));
        }
        let best = decisions.iter().enumerate().max_by(|(_, one), (_, other)| one.total_cmp(other));
        Ok(best.map_or(0, |(class, _)| class))
    }
}
