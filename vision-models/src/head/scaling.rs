//! Features of mean zero and variance one, for steps of one length.

use ndarray::{Array1, Array2, ArrayView2, Axis};

use super::LinearHead;
use crate::error::Error;

/// What features are trained on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FeatureScaling {
    /// As the network gives them.
    None,
    /// Each moved and scaled so that it has mean zero and variance one over the samples. The head takes the
    /// network's features as they are: it holds move and scale in its weights and biases.
    Standardised,
}

/// A feature that varies by less than this share of its size holds rounding only.
const CONSTANT: f64 = 1e-6;

/// The mean of each feature, and one over its standard deviation: zero for one that is constant.
#[derive(Clone, Debug)]
pub(super) struct Standardisation {
    mean: Array1<f64>,
    scale: Array1<f64>,
}

impl Standardisation {
    /// Over samples × features, at least one sample.
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

    /// The standardised samples.
    pub(super) fn apply(&self, samples: &ArrayView2<'_, f32>) -> Array2<f32> {
        let standardised = (samples.mapv(f64::from) - &self.mean) * &self.scale;
        #[allow(clippy::cast_possible_truncation)] // What a network computes with.
        standardised.mapv(|value| value as f32)
    }

    /// The head that gives to features as they are the scores that this one gives to standardised ones.
    ///
    /// # Errors
    /// None for a head of as many features.
    pub(super) fn fold(&self, head: &LinearHead) -> Result<LinearHead, Error> {
        let weights = head.weights.mapv(f64::from) * &self.scale;
        let biases = head.biases.mapv(f64::from) - weights.dot(&self.mean);
        #[allow(clippy::cast_possible_truncation)] // What a network computes with.
        let rounded = |value: f64| value as f32;
        LinearHead::new(head.classes.clone(), weights.mapv(rounded), biases.mapv(rounded))
    }
}
