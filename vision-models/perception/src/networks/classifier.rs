//! Converts an image file to scores of classes by a ResNet.

use std::path::Path;

use ndarray::Array4;
use vision_models::{Orientation, Preprocessing, ResNet, read_image_oriented};

use super::decider::Decider;
use crate::error::Error;

/// Preprocessing, network and deciders for images.
#[derive(Debug)]
pub struct Classifier {
    preprocessing: Preprocessing,
    network: ResNet,
    deciders: Vec<Decider>,
}

impl Classifier {
    /// Creates a classifier with this preprocessing. If there are no deciders, the network's own
    /// last layer decides.
    pub fn new(preprocessing: Preprocessing, network: ResNet, deciders: Vec<Decider>) -> Self {
        Self { preprocessing, network, deciders }
    }

    /// Reads an image in this orientation and returns the network's input.
    ///
    /// # Errors
    /// An error if the image cannot be used.
    pub fn read(&self, path: &Path, orientation: Orientation) -> Result<Array4<f32>, Error> {
        let image = read_image_oriented(path, orientation)?;
        Ok(self.preprocessing.image(image.view())?)
    }

    /// Returns the scores of the classes by each decider, before any softmax. `image` is the result
    /// of [`Self::read`].
    ///
    /// # Errors
    /// Those of [`ResNet::infer`] and [`Decider::scores`].
    pub fn scores(&mut self, image: &Array4<f32>) -> Result<Vec<Vec<f32>>, Error> {
        let scores = self.network.infer(image.view())?;
        if self.deciders.is_empty() {
            return Ok(vec![scores.logits.row(0).to_vec()]);
        }
        let features = scores.features.row(0);
        self.deciders.iter().map(|decider| decider.scores(features)).collect()
    }
}
