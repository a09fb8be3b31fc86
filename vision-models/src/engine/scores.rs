//! The scores of a classifier.

use ndarray::ArrayView2;

/// The scores and features of each input of a batch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scores<'a> {
    /// Scores before any softmax, N × classes.
    pub logits: ArrayView2<'a, f32>,
    /// Features, the input of the linear layer, N × features.
    pub features: ArrayView2<'a, f32>,
}
