//! Recognition while the frames come.

use std::{path::PathBuf, time::Instant};

use anyhow::{Result, ensure};
use ndarray::Axis;
use vision_models::{Crops, Preprocessing, SlowOnlyStream, read_image, softmax};

use super::{model::ActionModel, network::Window};
use crate::{learning::backbone::Weights, vision::errors::in_file};

/// A network over the last frames: every `interval`-th frame goes into its window, and gives a decision once the window
/// is full.
#[derive(Debug)]
pub struct LiveRecogniser<'a> {
    model: &'a ActionModel,
    preprocessing: Preprocessing,
    stream: SlowOnlyStream,
    /// Frames so far.
    frames: usize,
}

/// What one frame gave.
#[derive(Clone, Debug, PartialEq)]
pub struct Decision {
    /// The frame, counted from zero.
    pub frame: usize,
    /// The probability of each class.
    pub probabilities: Vec<f32>,
    /// From the frame's file to the probabilities (s).
    pub latency: f64,
}

impl<'a> LiveRecogniser<'a> {
    /// With an empty window.
    ///
    /// # Errors
    /// As of the network's loading.
    pub fn new(model: &'a ActionModel, weights: Weights, threads: usize) -> Result<Self> {
        let window = &model.window;
        let Window { length, side, .. } = *window;
        let network = window.backbone(weights, threads)?.load()?;
        let stream = SlowOnlyStream::new(network, [length, side, side])?;
        let preprocessing = window.preprocessing(Crops::Centre)?;
        Ok(Self { model, preprocessing, stream, frames: 0 })
    }

    /// Takes the next frame; a decision if it is one of the window's and the window is full.
    ///
    /// # Errors
    /// With the name of a frame that cannot be used.
    pub fn push(&mut self, path: &PathBuf) -> Result<Option<Decision>> {
        let frame = self.frames;
        self.frames += 1;
        if !frame.is_multiple_of(self.model.window.interval) {
            return Ok(None);
        }
        let start = Instant::now();
        let image = read_image(path)?;
        let image = self.preprocessing.image(image.view()).map_err(|error| in_file(path, error))?;
        let scores = self.stream.push(image.index_axis(Axis(0), 0))?;
        let Some(scores) = scores else { return Ok(None) };
        ensure!(scores.features.nrows() == 1, "the stream gave more than one window");
        let logits = self.model.head.scores(scores.features.row(0))?;
        let probabilities = softmax(&logits.to_vec());
        Ok(Some(Decision { frame, probabilities, latency: start.elapsed().as_secs_f64() }))
    }
}
