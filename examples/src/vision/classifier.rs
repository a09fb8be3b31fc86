//! From an image file to a ResNet's features and scores.

use std::path::{Path, PathBuf};

use anyhow::Result;
use ndarray::Array4;
use vision_models::{Error, NetworkKind, Options, Preprocessing, ResNet, ResNetDepth, read_image};

use super::{
    choices::Accepted,
    errors::{of_weights, open_checkpoint},
    folders::{LabelledImage, Unreadable},
};
use crate::program::{Ending, Session};

/// What an image goes through.
#[derive(Debug)]
pub struct Classifier {
    preprocessing: Preprocessing,
    network: ResNet,
    depth: ResNetDepth,
    weights: PathBuf,
}

/// What a ResNet says about an image.
#[derive(Clone, Debug, PartialEq)]
pub struct Scored {
    /// What the average pool gives.
    pub features: Vec<f32>,
    /// The class scores before any softmax.
    pub logits: Vec<f32>,
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
    ) -> Result<Self> {
        let options = Options { threads, ..Options::default() };
        let side = preprocessing.crop;
        let network = ResNet::load(depth, open_checkpoint(weights)?, [side, side], options)
            .map_err(|error| of_weights(weights, Accepted::ResNets, error))?;
        Ok(Self { preprocessing, network, depth, weights: weights.to_owned() })
    }

    /// The network with its file, for messages.
    pub fn describe(&self) -> String {
        format!("the {} of {}", NetworkKind::ResNet(self.depth.into()), self.weights.display())
    }

    /// How many classes the network has.
    pub fn classes(&self) -> usize {
        self.network.classes()
    }

    /// How many features the network has.
    pub fn features(&self) -> usize {
        self.network.features()
    }

    /// Reads an image and makes of it what the network sees.
    ///
    /// # Errors
    /// If the image cannot be used.
    pub fn read(&self, path: &Path) -> Result<Array4<f32>, Error> {
        self.preprocessing.image(read_image(path)?.view())
    }

    /// The network's scores of an image that [`Self::read`] gave.
    ///
    /// # Errors
    /// As of [`ResNet::infer`].
    pub fn infer(&mut self, image: &Array4<f32>) -> Result<Scored, Error> {
        let scores = self.network.infer(image.view())?;
        let row = |scores: ndarray::ArrayView2<'_, f32>| scores.iter().copied().collect();
        Ok(Scored { features: row(scores.features), logits: row(scores.logits) })
    }

    /// Scores images one by one, and gives each score to `each` with the image's class. What
    /// cannot be read is left out; an interrupt ends it early.
    ///
    /// # Errors
    /// As of [`Unreadable::leave_out`], [`Self::infer`] and `each`.
    pub fn score_each(
        &mut self,
        session: &Session,
        what: &str,
        images: &[LabelledImage],
        unreadable: &mut Unreadable,
        mut each: impl FnMut(usize, Scored) -> Result<()>,
    ) -> Result<Ending> {
        let progress = session.progress(what, images.len() as u64);
        for (done, LabelledImage { path, label }) in (1..).zip(images) {
            if session.interrupt().requested() {
                return Ok(Ending::Partial);
            }
            match self.read(path) {
                Ok(image) => each(*label, self.infer(&image)?)?,
                Err(error) => unreadable.leave_out(&progress, path, error)?,
            }
            progress.set(done);
        }
        Ok(Ending::Complete)
    }
}
