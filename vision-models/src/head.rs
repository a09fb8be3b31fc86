//! A network's last layer, trained on its features (paper, Sec. "Experiment 1": a new last layer on
//! a frozen network).
#![allow(clippy::needless_pass_by_value)] // views are passed by value, as usual with ndarray

mod scaling;
mod settings;
mod trainer;

use ndarray::{Array1, Array2, ArrayView1, ArrayView2, Axis};
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

pub use scaling::FeatureScaling;
pub use settings::HeadSettings;
pub use trainer::{Epoch, HeadTrainer};

use scaling::Standardisation;

use crate::error::Error;
use crate::random::uniform;
use crate::samples::{check_classes, check_finite, check_samples, misfit, not_finite};
use crate::weights::{Tensor, TensorSource, Tensors};

/// A linear layer from features to one score per class, the logits of [`softmax`](crate::softmax).
///
/// ```
/// use ndarray::{Array2, array};
/// use vision_models::{HeadSettings, LinearHead};
///
/// let features: Array2<f32> = array![[0.0, 1.0], [0.5, 2.0], [3.0, 1.0], [4.0, 0.5]];
/// let classes = vec!["smooth".into(), "drilled".into()];
/// let settings = HeadSettings { learning_rate: 0.1, dropout: 0.0, ..HeadSettings::default() };
/// let head = LinearHead::train(features.view(), &[0, 0, 1, 1], classes, &settings, |_| true)?;
/// assert_eq!(head.classify(features.row(2))?, 1);
///
/// // A file that PyTorch reads into a linear layer called "fc".
/// let mut file = Vec::new();
/// head.tensors("fc")?.write_safetensors(&mut file)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct LinearHead {
    classes: Vec<String>,
    /// Classes × features.
    weights: Array2<f32>,
    biases: Array1<f32>,
}

impl LinearHead {
    /// Largest number of training samples.
    pub const MAX_SAMPLES: usize = 10_000_000;

    /// Trains a head on features, samples × features. `labels` are the samples' classes as indices
    /// into `classes`.
    ///
    /// After each epoch `go_on` is called and decides whether to continue. The same samples and
    /// settings give the same head.
    ///
    /// # Errors
    /// [`Error::Malformed`] if one of these is wrong:
    /// - There are no samples, too many, or fewer than two classes.
    /// - Labels are missing or out of range.
    /// - A class has no sample, no name or the name of another class.
    /// - The steps diverge to infinity.
    ///
    /// [`Error::Value`] if a feature is not finite or a setting is out of range.
    pub fn train(
        samples: ArrayView2<'_, f32>,
        labels: &[usize],
        classes: Vec<String>,
        settings: &HeadSettings,
        mut go_on: impl FnMut(Epoch) -> bool,
    ) -> Result<Self, Error> {
        settings.validate()?;
        check_samples(&samples, labels, &classes, Self::MAX_SAMPLES)?;
        let start = Self::random(classes, samples.ncols(), settings.seed)?;
        let mut trainer = HeadTrainer::new(&start, *settings)?;
        let standardisation = match settings.scaling {
            FeatureScaling::None => None,
            FeatureScaling::Standardised => Some(Standardisation::of(&samples)),
        };
        let scaled =
            standardisation.as_ref().map(|standardisation| standardisation.apply(&samples));
        let samples = scaled.as_ref().map_or(samples, |scaled| scaled.view());
        for number in 1..=settings.epochs {
            let loss = trainer.epoch(samples, labels)?;
            if !go_on(Epoch { number, loss }) {
                break;
            }
        }
        let head = trainer.head();
        standardisation.map_or(Ok(head.clone()), |standardisation| standardisation.fold(&head))
    }

    /// Creates an initial head with weights and biases uniform within 1/√features, as in PyTorch's
    /// linear layer.
    ///
    /// # Errors
    /// [`Error::Malformed`] if there is no feature, there are fewer than two classes, or class
    /// names are empty or equal.
    pub fn random(classes: Vec<String>, features: usize, seed: u64) -> Result<Self, Error> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(1); // Different from the stream that orders the samples.
        let bound = 1.0 / (features as f64).sqrt();
        #[allow(clippy::cast_possible_truncation)] // Networks compute in f32.
        let mut draw = || (bound * (2.0 * uniform(&mut random) - 1.0)) as f32;
        let weights = Array2::from_shape_simple_fn((classes.len(), features), &mut draw);
        let biases = Array1::from_shape_simple_fn(classes.len(), &mut draw);
        Self::new(classes, weights, biases)
    }

    /// Creates a head with the given weights, classes × features.
    ///
    /// # Errors
    /// - [`Error::Malformed`] if the numbers of classes, weights and biases differ, or class names
    ///   are empty or equal.
    /// - [`Error::Value`] if a weight or bias is not finite.
    pub fn new(
        classes: Vec<String>,
        weights: Array2<f32>,
        biases: Array1<f32>,
    ) -> Result<Self, Error> {
        check_classes(&classes)?;
        let count = classes.len();
        if weights.nrows() != count || biases.len() != count || weights.ncols() == 0 {
            let problem = format!(
                "{count} classes have {} rows of {} weights and {} biases: give {count} of each",
                weights.nrows(),
                weights.ncols(),
                biases.len()
            );
            return Err(misfit(problem));
        }
        check_finite(&weights.view())?;
        if let Some((row, &value)) = biases.iter().enumerate().find(|(_, bias)| !bias.is_finite()) {
            return Err(not_finite(row, weights.ncols(), value.into()));
        }
        let weights = weights.as_standard_layout().into_owned();
        Ok(Self { classes, weights, biases })
    }

    /// Reads the layer `NAME.weight`, `NAME.bias` of a checkpoint. Its classes get the given names.
    ///
    /// # Errors
    /// - [`Error::Name`] if the layer is missing.
    /// - [`Error::Malformed`] if it has another shape.
    /// - Those of [`Self::new`].
    pub fn read(
        source: &mut impl TensorSource,
        name: &str,
        classes: Vec<String>,
    ) -> Result<Self, Error> {
        let weights = source.take(&format!("{name}.weight"))?;
        let biases = source.take(&format!("{name}.bias"))?;
        let &[rows, columns] = weights.shape() else {
            let shape = weights.shape();
            let problem = format!("{name}.weight has the shape {shape:?}: give classes × features");
            return Err(misfit(problem));
        };
        let fits = |error: ndarray::ShapeError| misfit(error.to_string());
        let weights = Array2::from_shape_vec((rows, columns), weights.into_data()).map_err(fits)?;
        Self::new(classes, weights, Array1::from_vec(biases.into_data()))
    }

    /// Returns the layer as tensors `NAME.weight` and `NAME.bias`.
    ///
    /// # Errors
    /// None known, since the shapes fit.
    pub fn tensors(&self, name: &str) -> Result<Tensors, Error> {
        let mut tensors = Tensors::new();
        let shape = self.weights.shape().to_vec();
        let weights = Tensor::new(shape, self.weights.iter().copied().collect())?;
        tensors.insert(format!("{name}.weight"), weights)?;
        let biases = Tensor::new(vec![self.biases.len()], self.biases.to_vec())?;
        tensors.insert(format!("{name}.bias"), biases)?;
        Ok(tensors)
    }

    /// Returns the names of the classes.
    pub fn classes(&self) -> &[String] {
        &self.classes
    }

    /// Returns the weights, classes × features.
    pub fn weights(&self) -> ArrayView2<'_, f32> {
        self.weights.view()
    }

    /// Returns the biases.
    pub fn biases(&self) -> ArrayView1<'_, f32> {
        self.biases.view()
    }

    /// Returns one score per class.
    ///
    /// # Errors
    /// - [`Error::Malformed`] if the number of features differs from the training's.
    /// - [`Error::Value`] if a feature is not finite.
    pub fn scores(&self, features: ArrayView1<'_, f32>) -> Result<Array1<f32>, Error> {
        if features.len() != self.weights.ncols() {
            let problem = format!(
                "{} features were given to a head that was trained with {}",
                features.len(),
                self.weights.ncols()
            );
            return Err(misfit(problem));
        }
        check_finite(&features.insert_axis(Axis(0)))?;
        Ok(self.weights.dot(&features) + &self.biases)
    }

    /// Returns the index of the class with the highest score, the first of equal ones.
    ///
    /// # Errors
    /// Those of [`Self::scores`].
    pub fn classify(&self, features: ArrayView1<'_, f32>) -> Result<usize, Error> {
        let scores = self.scores(features)?;
        let best =
            scores.iter().enumerate().rev().max_by(|(_, one), (_, other)| one.total_cmp(other));
        Ok(best.map_or(0, |(class, _)| class))
    }
}
