//! Networks that compute features.

use std::{fmt, path::PathBuf};

use ndarray::{Array4, Array5};
use serde::{Deserialize, Serialize};
use vision_models::{
    InflatedResNet, NetworkKind, Options, ResNet, ResNetForm, SlowOnly, SlowOnlyForm,
};

use super::{digest::Digest, random_network::random_network};
use crate::{error::Error, networks::checkpoint::open_weights, watch::Watch};

/// The source of a network's weights.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Weights {
    /// A checkpoint.
    File(PathBuf),
    /// Random weights from this seed, without training.
    Random(u64),
}

impl Weights {
    /// Returns the identity of the weights.
    ///
    /// # Errors
    /// [`Error::Read`] if the file cannot be read, [`Error::Stopped`] if the call-back stops the
    /// work.
    pub fn identity(&self, watch: &mut Watch<'_>) -> Result<WeightsIdentity, Error> {
        Ok(match self {
            Self::File(path) => WeightsIdentity::Sha256(Digest::of_file(path, watch)?.to_string()),
            Self::Random(seed) => WeightsIdentity::RandomSeed(*seed),
        })
    }
}

/// The identity of weights.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WeightsIdentity {
    /// SHA-256 of the checkpoint.
    Sha256(String),
    /// Seed of random weights.
    RandomSeed(u64),
}

impl WeightsIdentity {
    /// Returns the weights with this identity: those of the given checkpoint, or random ones.
    ///
    /// # Errors
    /// [`Error::NoWeights`] if the checkpoint is missing, [`Error::Unfit`] if it is another one.
    pub fn weights(&self, file: Option<PathBuf>, watch: &mut Watch<'_>) -> Result<Weights, Error> {
        match (file, self) {
            (None, Self::RandomSeed(seed)) => Ok(Weights::Random(*seed)),
            (None, Self::Sha256(_)) => Err(Error::NoWeights { identity: self.to_string() }),
            (Some(file), _) => {
                let shown = file.display().to_string();
                let weights = Weights::File(file);
                let own = weights.identity(watch)?;
                if own == *self {
                    return Ok(weights);
                }
                let found = format!("these are {own}, but the model was trained with {self}");
                Err(Error::at(shown, found))
            }
        }
    }
}

impl fmt::Display for WeightsIdentity {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Sha256(sha256) => write!(formatter, "the weights with SHA-256 {sha256}"),
            Self::RandomSeed(seed) => write!(formatter, "random weights of seed {seed}"),
        }
    }
}

/// A network for images that is loaded when it is first used.
///
/// ```
/// use std::ops::ControlFlow;
///
/// use human_perception::{Event, learning::backbone::{ImageBackbone, Weights}};
/// use ndarray::Array4;
/// use vision_models::ResNetDepth;
///
/// let watch = &mut |_: Event<'_>| ControlFlow::Continue(());
/// let mut network = ImageBackbone::new(Weights::Random(1), ResNetDepth::Eighteen, 32, 1);
/// assert_eq!(network.features(&Array4::zeros((1, 3, 32, 32)), watch)?.len(), 512);
/// # Ok::<(), human_perception::Error>(())
/// ```
#[derive(Debug)]
pub struct ImageBackbone {
    weights: Weights,
    form: ResNetForm,
    options: Options,
    side: usize,
    network: Option<ResNet>,
}

impl ImageBackbone {
    /// Creates a network for square images of this side.
    pub fn new(weights: Weights, form: impl Into<ResNetForm>, side: usize, threads: usize) -> Self {
        let options = Options { threads, ..Options::default() };
        Self { weights, form: form.into(), options, side, network: None }
    }

    /// Returns the features of a normalised image. The array is N × 3 × side × side. The first
    /// image is used.
    ///
    /// # Errors
    /// Those of [`ResNet::load`] and [`ResNet::infer`].
    pub fn features(
        &mut self,
        image: &Array4<f32>,
        watch: &mut Watch<'_>,
    ) -> Result<Vec<f32>, Error> {
        if self.network.is_none() {
            self.network = Some(self.load(watch)?);
        }
        let Some(network) = &mut self.network else { return Ok(Vec::new()) };
        Ok(network.infer(image.view())?.features.row(0).to_vec())
    }

    /// Loads the network.
    ///
    /// # Errors
    /// Those of [`ResNet::load`].
    pub fn load(&self, watch: &mut Watch<'_>) -> Result<ResNet, Error> {
        let (form, size, options) = (self.form, [self.side, self.side], self.options);
        match &self.weights {
            Weights::File(path) => ResNet::load(form, open_weights(path, watch)?, size, options)
                .map_err(Error::weights(path)),
            Weights::Random(seed) => {
                let tensors = random_network(NetworkKind::ResNet(form), *seed)?;
                Ok(ResNet::load(form, tensors, size, options)?)
            }
        }
    }
}

/// A network for clips that is loaded when it is first used.
#[derive(Debug)]
pub struct ClipBackbone {
    weights: Weights,
    form: SlowOnlyForm,
    options: Options,
    /// Number of frames, rows and columns.
    size: [usize; 3],
    network: Option<SlowOnly>,
}

impl ClipBackbone {
    /// Creates a network for clips of this size: frames, rows, columns.
    pub fn new(weights: Weights, form: SlowOnlyForm, size: [usize; 3], threads: usize) -> Self {
        let options = Options { threads, ..Options::default() };
        Self { weights, form, options, size, network: None }
    }

    /// Returns the concatenated features of normalised clips, N × 3 × frames × rows × columns.
    ///
    /// # Errors
    /// Those of [`SlowOnly::load`] and [`SlowOnly::infer`].
    pub fn features(
        &mut self,
        clips: &Array5<f32>,
        watch: &mut Watch<'_>,
    ) -> Result<Vec<f32>, Error> {
        if self.network.is_none() {
            self.network = Some(self.load(watch)?);
        }
        let Some(network) = &mut self.network else { return Ok(Vec::new()) };
        Ok(network.infer(clips.view())?.features.iter().copied().collect())
    }

    /// Loads the network. Weights of a ResNet for images are inflated ([`InflatedResNet`]).
    ///
    /// # Errors
    /// Those of [`SlowOnly::load`].
    pub fn load(&self, watch: &mut Watch<'_>) -> Result<SlowOnly, Error> {
        match &self.weights {
            Weights::File(path) => {
                let weights = open_weights(path, watch)?;
                let (form, size, options) = (self.form, self.size, self.options);
                let of_images = matches!(NetworkKind::of(&weights), Some(NetworkKind::ResNet(_)));
                let network = if of_images {
                    InflatedResNet::new(form, weights)
                        .and_then(|weights| SlowOnly::load(form, weights, size, options))
                } else {
                    SlowOnly::load(form, weights, size, options)
                };
                network.map_err(Error::weights(path))
            }
            Weights::Random(seed) => {
                let tensors = random_network(NetworkKind::SlowOnly(self.form), *seed)?;
                Ok(SlowOnly::load(self.form, tensors, self.size, self.options)?)
            }
        }
    }
}
