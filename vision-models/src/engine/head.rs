//! The end of a classifier: pooling of the last activation, then a linear layer.

use crate::error::Error;
use crate::layout::{Channels, Layout, offset, position};

/// Pooling of the last activation to a vector of features.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pooling {
    /// The mean over all frames, rows and columns.
    Mean,
    /// The mean of the means of all windows of this size (frames, rows, columns) with a stride of
    /// one. The linear layer is affine, so it may be applied before or after.
    Windows([usize; 3]),
}

impl Pooling {
    /// Returns the weight of each index of an axis of this length.
    fn weights(self, axis: usize, length: usize) -> Result<Vec<f64>, Error> {
        match self {
            Self::Mean => Ok(vec![1.0 / length as f64; length]),
            Self::Windows(windows) => {
                let window = windows[axis];
                if length < window {
                    let unit = ["frames", "rows", "columns"][axis];
                    let wanted = format!(
                        "more frames or larger images, as the head's window takes {window}"
                    );
                    return Err(Error::size("the last activation", &[length], unit, &wanted));
                }
                let positions = length - window + 1;
                let total = (positions * window) as f64;
                let covering = |index: usize| {
                    (index + 1).min(window).min(positions).min(length - index) as f64 / total
                };
                Ok((0..length).map(covering).collect())
            }
        }
    }

    /// Returns the weight of each pixel, in order.
    pub(crate) fn pixel_weights(self, layout: &Layout) -> Result<Vec<f32>, Error> {
        let axes = [0, 1, 2].map(|axis| self.weights(axis, layout.size[axis]));
        let [frames, rows, columns] = axes;
        let (frames, rows, columns) = (frames?, rows?, columns?);
        #[expect(clippy::cast_possible_truncation, reason = "the features are f32")]
        let weight = |index| {
            let [frame, row, column] = position(index, layout.size);
            (frames[frame] * rows[row] * columns[column]) as f32
        };
        Ok((0..layout.pixels()).map(weight).collect())
    }
}

/// Computes the weighted sum of all pixels.
pub(crate) fn pool(weights: &[f32], (input, from): (&[f32], &Channels), features: &mut [f32]) {
    let layout = from.layout;
    features.fill(0.0);
    for (index, &weight) in weights.iter().enumerate() {
        let start = from.origin() + offset(position(index, layout.size), layout.strides());
        let pixel = &input[start..start + features.len()];
        for (feature, value) in features.iter_mut().zip(pixel) {
            *feature += weight * value;
        }
    }
}
