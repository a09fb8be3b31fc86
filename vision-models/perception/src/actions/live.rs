//! Recognition while the frames come.

use std::{path::Path, time::Instant};

use vision_models::Crops;

use super::{model::ActionModel, window::Window};
use crate::{
    error::Error, learning::backbone::Weights, networks::clip_stream::ClipStream, watch::Watch,
};

/// A network over the last frames: every `interval`-th frame goes into its window, and gives a decision once the
/// window is full.
#[derive(Debug)]
pub struct LiveRecogniser {
    stream: ClipStream,
    interval: usize,
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

impl ActionModel {
    /// The network with its head over a sliding window.
    ///
    /// # Errors
    /// As of the network's loading.
    pub fn stream(
        &self,
        weights: Weights,
        threads: usize,
        watch: &mut Watch<'_>,
    ) -> Result<ClipStream, Error> {
        let network = self.window.backbone(weights, threads)?.load(watch)?;
        let preprocessing = self.window.preprocessing(Crops::Centre)?;
        let Window { length, .. } = self.window;
        ClipStream::new(network, length, preprocessing, Some(self.head.clone()))
    }
}

impl LiveRecogniser {
    /// With an empty window.
    pub fn new(stream: ClipStream, interval: usize) -> Self {
        Self { stream, interval, frames: 0 }
    }

    /// Takes the next frame; a decision if it is one of the window's and the window is full.
    ///
    /// # Errors
    /// With the name of a frame that cannot be used.
    pub fn push(&mut self, path: &Path) -> Result<Option<Decision>, Error> {
        let frame = self.frames;
        self.frames += 1;
        if !frame.is_multiple_of(self.interval) {
            return Ok(None);
        }
        let start = Instant::now();
        let probabilities = self.stream.push(path)?;
        let latency = start.elapsed().as_secs_f64();
        Ok(probabilities.map(|probabilities| Decision { frame, probabilities, latency }))
    }
}
