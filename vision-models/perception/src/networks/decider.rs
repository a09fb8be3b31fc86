//! What decides over the features of a network, in place of its own last layer.

use ndarray::ArrayView1;
use vision_models::{LinearHead, LinearSvm};

use crate::error::Error;

/// One of the paper's ways to decide.
#[derive(Clone, Debug)]
pub enum Decider {
    /// A new last layer.
    Head(LinearHead),
    /// A support vector machine.
    Svm(LinearSvm),
}

impl Decider {
    /// One score a class; the highest decides.
    ///
    /// # Errors
    /// [`Error::Vision`] for another number of features than in training.
    #[allow(clippy::needless_pass_by_value)] // views go by value, as everywhere in ndarray
    pub fn scores(&self, features: ArrayView1<'_, f32>) -> Result<Vec<f32>, Error> {
        match self {
            Self::Head(head) => Ok(head.scores(features)?.to_vec()),
            Self::Svm(svm) => {
                #[expect(clippy::cast_possible_truncation, reason = "the scores of a network, too")]
                let scores: Vec<f32> =
                    svm.decide(features)?.iter().map(|score| *score as f32).collect();
                // One plane between two classes; its positive side is the second's.
                Ok(if let [score] = scores[..] { vec![-score, score] } else { scores })
            }
        }
    }
}
