//! From an image file to scores of classes, by a ResNet.

use std::path::Path;

use ndarray::Array4;
use vision_models::{Options, Orientation, Preprocessing, ResNet, ResNetForm, read_image_oriented};

use super::{checkpoint::open_weights, decider::Decider};
use crate::{error::Error, watch::Watch};

/// Loads a ResNet for square images of this side.
///
/// # Errors
/// With the checkpoint's name; one that holds another network says which.
pub fn load_resnet(
    weights: &Path,
    form: impl Into<ResNetForm>,
    side: usize,
    threads: usize,
    watch: &mut Watch<'_>,
) -> Result<ResNet, Error> {
    let options = Options { threads, ..Options::default() };
    ResNet::load(form, open_weights(weights, watch)?, [side, side], options)
        .map_err(Error::weights(weights))
}

/// What an image goes through.
#[derive(Debug)]
pub struct Classifier {
    preprocessing: Preprocessing,
    network: ResNet,
    deciders: Vec<Decider>,
}

impl Classifier {
    /// A network for images that are prepared so. Without deciders its own last layer decides.
    pub fn new(preprocessing: Preprocessing, network: ResNet, deciders: Vec<Decider>) -> Self {
        Self { preprocessing, network, deciders }
    }

    /// How many classes the network's own last layer has.
    pub fn classes(&self) -> usize {
        self.network.classes()
    }

    /// Reads an image, this way up, and makes of it what the network sees.
    ///
    /// # Errors
    /// If the image cannot be used.
    pub fn read(&self, path: &Path, orientation: Orientation) -> Result<Array4<f32>, Error> {
        let image = read_image_oriented(path, orientation)?;
        Ok(self.preprocessing.image(image.view())?)
    }

    /// The scores of the classes in an image that [`Self::read`] gave, by each decider, before any softmax.
    ///
    /// # Errors
    /// As of [`ResNet::infer`] and [`Decider::scores`].
    pub fn scores(&mut self, image: &Array4<f32>) -> Result<Vec<Vec<f32>>, Error> {
        let scores = self.network.infer(image.view())?;
        if self.deciders.is_empty() {
            return Ok(vec![scores.logits.row(0).to_vec()]);
        }
        let features = scores.features.row(0);
        self.deciders.iter().map(|decider| decider.scores(features)).collect()
    }
}
