//! From an image file to a ResNet's class scores.

use std::path::Path;

use ndarray::Array4;
use vision_models::{
    Options, Orientation, Preprocessing, ResNet, ResNetDepth, read_image_oriented,
};

use super::open_weights;
use crate::{Error, Watch};

/// Loads a ResNet for square images of this side.
///
/// # Errors
/// With the checkpoint's name; one that holds another network says which.
pub fn load_resnet(
    weights: &Path,
    depth: ResNetDepth,
    side: usize,
    threads: usize,
    watch: &mut Watch<'_>,
) -> Result<ResNet, Error> {
    let options = Options { threads, ..Options::default() };
    ResNet::load(depth, open_weights(weights, watch)?, [side, side], options)
        .map_err(Error::weights(weights))
}

/// What an image goes through.
#[derive(Debug)]
pub struct Classifier {
    preprocessing: Preprocessing,
    network: ResNet,
}

impl Classifier {
    /// Loads the network.
    ///
    /// # Errors
    /// With the checkpoint's name; one that holds another network says which.
    pub fn load(
        weights: &Path,
        depth: ResNetDepth,
        preprocessing: Preprocessing,
        threads: usize,
        watch: &mut Watch<'_>,
    ) -> Result<Self, Error> {
        let network = load_resnet(weights, depth, preprocessing.crop, threads, watch)?;
        Ok(Self { preprocessing, network })
    }

    /// How many classes the network has.
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

    /// The network's class scores of an image that [`Self::read`] gave, before any softmax.
    ///
    /// # Errors
    /// As of [`ResNet::infer`].
    pub fn infer(&mut self, image: &Array4<f32>) -> Result<Vec<f32>, Error> {
        Ok(self.network.infer(image.view())?.logits.iter().copied().collect())
    }
}
