//! Classifiers on the features of a network that replace its own last layer.

use ndarray::ArrayView1;
use vision_models::{LinearHead, LinearSvm};

use crate::error::Error;

/// One of the paper's classifiers.
#[derive(Clone, Debug)]
pub enum Decider {
    /// A new last layer.
    Head(LinearHead),
    /// A support vector machine.
    Svm(LinearSvm),
}

impl Decider {
    /// Returns one score per class. The highest decides.
    ///
    /// # Errors
    /// [`Error::Vision`] if the number of features differs from the training's.
    #[allow(clippy::needless_pass_by_value)] // views are passed by value, as usual with ndarray
    pub fn scores(&self, features: ArrayView1<'_, f32>) -> Result<Vec<f32>, Error> {
        match self {
            Self::Head(head) => Ok(head.scores(features)?.to_vec()),
            Self::Svm(svm) => {
                #[expect(clippy::cast_possible_truncation, reason = "the scores of a network, too")]
                let scores: Vec<f32> =
                    svm.decide(features)?.iter().map(|score| *score as f32).collect();
                // Two classes have one plane, whose positive side is the second class.
                Ok(if let [score] = scores[..] { vec![-score, score] } else { scores })
            }
        }
    }
}
