//! Converts the frames of a video to probabilities of classes by SlowOnly.

use std::path::PathBuf;

use ndarray::ArrayView1;
use vision_models::{LinearHead, Preprocessing, Scores, SlowOnly, softmax};

use super::clips::read_clip;
use crate::{
    error::Error,
    watch::{Event, Watch},
};

/// SlowOnly for clips, with the preprocessing of its frames.
#[derive(Debug)]
pub struct ClipClassifier {
    network: SlowOnly,
    preprocessing: Preprocessing,
    /// The head that replaces the network's own last layer.
    head: Option<LinearHead>,
}

/// A network's results for clips of a video.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ClipScores {
    /// Mean probability of each class over all views.
    pub probabilities: Vec<f32>,
    /// Number of clips.
    pub clips: usize,
    /// Number of clips and crops whose probabilities were averaged.
    pub views: usize,
}

impl ClipClassifier {
    /// Creates a classifier with this preprocessing. If there is no head, the network's own last
    /// layer decides.
    pub fn new(network: SlowOnly, preprocessing: Preprocessing, head: Option<LinearHead>) -> Self {
        Self { network, preprocessing, head }
    }

    /// Returns the mean over clips at these positions among the frames. If the call-back stops the
    /// work, over those so far.
    ///
    /// # Errors
    /// Names a frame that cannot be used.
    pub fn run(
        &mut self,
        frames: &[PathBuf],
        clips: &[Vec<usize>],
        watch: &mut Watch<'_>,
    ) -> Result<ClipScores, Error> {
        let (what, all) = ("clips", clips.len() as u64);
        let mut sums = ClipScores::default();
        for (done, clip) in (0..).zip(clips) {
            let _ = watch(Event::Progress { what, done, all });
            let Some(crops) = read_clip(&self.preprocessing, frames, clip, watch)? else { break };
            let scores = self.network.infer(crops.view())?;
            for view in 0..crops.dim().0 {
                let probabilities = probabilities(self.head.as_ref(), &scores, view)?;
                sums.probabilities.resize(probabilities.len(), 0.0);
                for (sum, probability) in sums.probabilities.iter_mut().zip(probabilities) {
                    *sum += probability;
                }
                sums.views += 1;
            }
            sums.clips += 1;
        }
        let _ = watch(Event::Progress { what, done: all, all });
        let views = sums.views as f32;
        sums.probabilities.iter_mut().for_each(|sum| *sum /= views);
        Ok(sums)
    }
}

/// Returns the probability of each class in one of the inputs, by a head or the network's own last
/// layer.
pub(super) fn probabilities(
    head: Option<&LinearHead>,
    scores: &Scores<'_>,
    input: usize,
) -> Result<Vec<f32>, Error> {
    let row: ArrayView1<'_, f32> = scores.features.row(input);
    Ok(softmax(&match head {
        Some(head) => head.scores(row)?.to_vec(),
        None => scores.logits.row(input).to_vec(),
    }))
}
