//! Conversion of images to clips of one frame.

use ndarray::{ArrayView4, ArrayView5, Axis};

/// Returns N × channels × height × width as N × channels × 1 × height × width.
pub(super) fn from_images(images: ArrayView4<'_, f32>) -> ArrayView5<'_, f32> {
    images.insert_axis(Axis(2))
}
