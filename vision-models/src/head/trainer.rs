//! Stochastic gradient descent on the cross-entropy of a linear head.

use ndarray::{Array1, Array2, ArrayView2, Axis};
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

use super::LinearHead;
use crate::error::Error;
use crate::head::settings::HeadSettings;
use crate::random::{shuffle, uniform};
use crate::samples::{check_finite, check_labels, misfit};

/// The result of one pass through all samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Epoch {
    /// The epoch's number. The first is 1.
    pub number: usize,
    /// Mean cross-entropy of the epoch's steps, computed with dropout.
    pub loss: f64,
}

/// Trains a head step by step, on batches that the caller chooses. [`LinearHead::train`] goes
/// through all samples in random order.
///
/// A step is PyTorch's: `v ← momentum v + g`, `w ← w - learning_rate v`. Here g is the gradient of
/// the mean cross-entropy and the weight decay, and v = 0 at the beginning. It is computed in f64.
///
/// ```
/// use ndarray::array;
/// use vision_models::{HeadSettings, HeadTrainer, LinearHead};
///
/// let settings = HeadSettings { learning_rate: 0.1, dropout: 0.0, ..HeadSettings::default() };
/// let head = LinearHead::random(vec!["smooth".into(), "drilled".into()], 2, 1)?;
/// let mut trainer = HeadTrainer::new(&head, settings)?;
/// let samples = array![[0.0_f32, 1.0], [1.0, 0.0]];
/// let first = trainer.step(samples.view(), &[0, 1])?;
/// for _ in 0..50 {
///     trainer.step(samples.view(), &[0, 1])?;
/// }
/// assert!(trainer.step(samples.view(), &[0, 1])? < 0.5 * first);
/// assert_eq!(trainer.head().classify(samples.row(1))?, 1);
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct HeadTrainer {
    settings: HeadSettings,
    classes: Vec<String>,
    /// Classes × features.
    weights: Array2<f64>,
    biases: Array1<f64>,
    weight_velocity: Array2<f64>,
    bias_velocity: Array1<f64>,
    random: ChaCha8Rng,
}

impl HeadTrainer {
    /// Creates a trainer that begins with this head.
    ///
    /// # Errors
    /// [`Error::Value`].
    pub fn new(head: &LinearHead, settings: HeadSettings) -> Result<Self, Error> {
        settings.validate()?;
        let weights = head.weights().mapv(f64::from);
        let biases = head.biases().mapv(f64::from);
        Ok(Self {
            settings,
            classes: head.classes().to_vec(),
            weight_velocity: Array2::zeros(weights.dim()),
            bias_velocity: Array1::zeros(biases.dim()),
            weights,
            biases,
            random: ChaCha8Rng::seed_from_u64(settings.seed),
        })
    }

    /// Returns the current head, rounded to f32.
    pub fn head(&self) -> LinearHead {
        #[allow(clippy::cast_possible_truncation)] // Networks compute in f32.
        let rounded = |value: &f64| *value as f32;
        LinearHead {
            classes: self.classes.clone(),
            weights: self.weights.map(rounded),
            biases: self.biases.map(rounded),
        }
    }

    /// Makes one step along the gradient of a batch, samples × features. Returns the mean
    /// cross-entropy before it.
    ///
    /// # Errors
    /// - [`Error::Malformed`] if the batch is empty, the number of features or labels is wrong, a
    ///   label is no class, or the step makes weights infinite.
    /// - [`Error::Value`] if a feature is not finite.
    ///
    /// The head is then unchanged.
    pub fn step(&mut self, samples: ArrayView2<'_, f32>, labels: &[usize]) -> Result<f64, Error> {
        let (count, features) = samples.dim();
        if count == 0 || labels.len() != count || features != self.weights.ncols() {
            let problem = format!(
                "a batch of {count} samples of {features} features has {} labels: give at least one \
                 sample, {} features and a label each",
                labels.len(),
                self.weights.ncols()
            );
            return Err(misfit(problem));
        }
        check_labels(labels, &self.classes)?;
        check_finite(&samples)?;
        let samples = self.dropped(samples.mapv(f64::from));
        let mut errors = samples.dot(&self.weights.t()) + &self.biases;
        let mut loss = 0.0;
        for (mut row, &label) in errors.outer_iter_mut().zip(labels) {
            loss += cross_entropy_and_gradient(row.as_slice_mut().unwrap_or_default(), label);
        }
        errors /= count as f64;
        let decay = self.settings.weight_decay;
        let weight_gradient = errors.t().dot(&samples) + decay * &self.weights;
        let bias_gradient = errors.sum_axis(Axis(0)) + decay * &self.biases;
        let HeadSettings { momentum, learning_rate, .. } = self.settings;
        let weight_velocity = momentum * &self.weight_velocity + weight_gradient;
        let bias_velocity = momentum * &self.bias_velocity + bias_gradient;
        let weights = &self.weights - learning_rate * &weight_velocity;
        let biases = &self.biases - learning_rate * &bias_velocity;
        let largest = f64::from(f32::MAX);
        if !weights.iter().chain(&biases).all(|value| value.abs() <= largest) {
            let problem = format!(
                "a step of learning rate {learning_rate} makes weights infinite: give a smaller one, \
                 or smaller features"
            );
            return Err(misfit(problem));
        }
        self.weights = weights;
        self.biases = biases;
        self.weight_velocity = weight_velocity;
        self.bias_velocity = bias_velocity;
        Ok(loss / count as f64)
    }

    /// Returns the samples with features left out at random.
    fn dropped(&mut self, mut samples: Array2<f64>) -> Array2<f64> {
        let dropout = self.settings.dropout;
        if dropout > 0.0 {
            let random = &mut self.random;
            samples.mapv_inplace(|value| {
                if uniform(random) < dropout { 0.0 } else { value / (1.0 - dropout) }
            });
        }
        samples
    }

    /// Goes through all samples once in random order. Returns the mean loss of the steps, weighted
    /// by their samples.
    pub(super) fn epoch(
        &mut self,
        samples: ArrayView2<'_, f32>,
        labels: &[usize],
    ) -> Result<f64, Error> {
        let mut order: Vec<usize> = (0..labels.len()).collect();
        shuffle(&mut order, &mut self.random);
        let mut sum = 0.0;
        for batch in order.chunks(self.settings.batch) {
            let of_batch = samples.select(Axis(0), batch);
            let labels: Vec<usize> =
                batch.iter().filter_map(|&sample| labels.get(sample).copied()).collect();
            sum += self.step(of_batch.view(), &labels)? * batch.len() as f64;
        }
        Ok(sum / labels.len() as f64)
    }
}

/// Returns the cross-entropy of a sample's scores and replaces them by its gradient, softmax minus
/// the class.
fn cross_entropy_and_gradient(scores: &mut [f64], label: usize) -> f64 {
    let highest = scores.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let own = scores.get(label).copied().unwrap_or(highest);
    for score in &mut *scores {
        *score = (*score - highest).exp();
    }
    let sum: f64 = scores.iter().sum();
    for (class, score) in scores.iter_mut().enumerate() {
        *score = *score / sum - f64::from(class == label);
    }
    sum.ln() + highest - own
}
