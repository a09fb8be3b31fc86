//! Standardisation of features to mean zero and variance one, so that one step length fits all.

use ndarray::{Array1, Array2, ArrayView2, Axis};

use super::LinearHead;
use crate::error::Error;

/// Scaling of the features for training.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FeatureScaling {
    /// The features as the network gives them.
    None,
    /// Each feature is shifted and scaled to mean zero and variance one over the samples. The head
    /// accepts unscaled features: shift and scale are folded into its weights and biases.
    Standardised,
}

/// A feature whose relative variation is smaller than this contains only rounding errors.
const CONSTANT: f64 = 1e-6;

/// The mean of each feature, and one over its standard deviation. The latter is zero for a constant
/// feature.
#[derive(Clone, Debug)]
pub(super) struct Standardisation {
    mean: Array1<f64>,
    scale: Array1<f64>,
}

impl Standardisation {
    /// Computes both over samples × features, at least one sample.
    pub(super) fn of(samples: &ArrayView2<'_, f32>) -> Self {
        let samples = samples.mapv(f64::from);
        let mean = samples.mean_axis(Axis(0)).unwrap_or_else(|| Array1::zeros(samples.ncols()));
        let mut scale = samples.var_axis(Axis(0), 0.0).mapv(f64::sqrt);
        for (scale, (feature, mean)) in scale.iter_mut().zip(samples.axis_iter(Axis(1)).zip(&mean))
        {
            let largest = feature.iter().fold(mean.abs(), |a, b| a.max(b.abs()));
            *scale = if *scale > CONSTANT * largest { 1.0 / *scale } else { 0.0 };
        }
        Self { mean, scale }
    }

    /// Returns the standardised samples.
    pub(super) fn apply(&self, samples: &ArrayView2<'_, f32>) -> Array2<f32> {
        let standardised = (samples.mapv(f64::from) - &self.mean) * &self.scale;
        #[allow(clippy::cast_possible_truncation)] // Networks compute in f32.
        standardised.mapv(|value| value as f32)
    }

    /// Returns the head that gives unscaled features the same scores as `head` gives standardised
    /// ones.
    ///
    /// # Errors
    /// None if the head has as many features.
    pub(super) fn fold(&self, head: &LinearHead) -> Result<LinearHead, Error> {
        let weights = head.weights.mapv(f64::from) * &self.scale;
        let biases = head.biases.mapv(f64::from) - weights.dot(&self.mean);
        #[allow(clippy::cast_possible_truncation)] // Networks compute in f32.
        let rounded = |value: f64| value as f32;
        LinearHead::new(head.classes.clone(), weights.mapv(rounded), biases.mapv(rounded))
    }
}
