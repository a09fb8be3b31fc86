//! The differences between the training libraries.

use ndarray::{Array3, ArrayView3};

use super::{antialiased, interpolated};

/// The library with which a network was trained. Libraries resize, round and normalise differently,
/// which changes a network's results.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Library {
    /// torchvision with Pillow images: bilinear with antialiasing.
    Torchvision,
    /// mmaction2 with OpenCV images: bilinear without antialiasing.
    Mmaction2,
    /// PyTorchVideo: bilinear without antialiasing, in f32.
    PyTorchVideo,
}

impl Library {
    /// Returns the mean and the standard deviation of each channel (red, green, blue), for pixels
    /// from 0 to [`Self::white`].
    pub fn normalisation(self) -> [[f32; 3]; 2] {
        match self {
            Self::Torchvision => [[0.485, 0.456, 0.406], [0.229, 0.224, 0.225]],
            Self::Mmaction2 => [[123.675, 116.28, 103.53], [58.395, 57.12, 57.375]],
            Self::PyTorchVideo => [[0.45; 3], [0.225; 3]],
        }
    }

    /// Returns the value of a white pixel before the normalisation.
    pub fn white(self) -> f32 {
        match self {
            Self::Torchvision | Self::PyTorchVideo => 1.0,
            Self::Mmaction2 => 255.0,
        }
    }

    /// Resizes a height × width × 3 image. Pixels stay between 0 and 255.
    pub(super) fn resize(
        self,
        frame: ArrayView3<'_, u8>,
        height: usize,
        width: usize,
    ) -> Array3<f32> {
        match self {
            Self::Torchvision => antialiased::resize(frame, height, width).mapv(f32::from),
            Self::Mmaction2 => interpolated::resize_opencv(frame, height, width).mapv(f32::from),
            Self::PyTorchVideo => interpolated::resize_torch(frame, height, width),
        }
    }

    /// Returns the long side after the short one is resized from `short` to `size`.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    pub(super) fn long_side(self, long: usize, short: usize, size: usize) -> usize {
        match self {
            Self::Torchvision => size.saturating_mul(long) / short,
            Self::Mmaction2 => (long as f64 * (size as f64 / short as f64) + 0.5) as usize,
            Self::PyTorchVideo => (long as f64 / short as f64 * size as f64) as usize,
        }
    }

    /// Returns the start of a crop of `crop` in the middle of `size`.
    pub(super) fn middle(self, size: usize, crop: usize) -> usize {
        let rest = size - crop;
        match self {
            // Rounded half to even.
            Self::Torchvision | Self::PyTorchVideo => rest / 2 + usize::from(rest % 4 == 3),
            Self::Mmaction2 => rest / 2,
        }
    }
}
