//! What differs between the training libraries.

use ndarray::{Array3, ArrayView3};

use super::{antialiased, interpolated};

/// The library that a network was trained with. Each resizes, rounds and normalises its own way,
/// and a network sees the difference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Library {
    /// torchvision with Pillow images: bilinear with antialiasing.
    Torchvision,
    /// mmaction2 with OpenCV images: bilinear without.
    Mmaction2,
    /// PyTorchVideo: bilinear without, in f32.
    PyTorchVideo,
}

impl Library {
    /// The mean and the standard deviation of each channel (red, green, blue), of pixels from 0 to
    /// [`Self::white`].
    pub fn normalisation(self) -> [[f32; 3]; 2] {
        match self {
            Self::Torchvision => [[0.485, 0.456, 0.406], [0.229, 0.224, 0.225]],
            Self::Mmaction2 => [[123.675, 116.28, 103.53], [58.395, 57.12, 57.375]],
            Self::PyTorchVideo => [[0.45; 3], [0.225; 3]],
        }
    }

    /// The value of a white pixel before the normalisation.
    pub fn white(self) -> f32 {
        match self {
            Self::Torchvision | Self::PyTorchVideo => 1.0,
            Self::Mmaction2 => 255.0,
        }
    }

    /// Resizes a height × width × 3 image; pixels stay between 0 and 255.
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

    /// The long side when the short one goes from `short` to `size`.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    pub(super) fn long_side(self, long: usize, short: usize, size: usize) -> usize {
        match self {
            Self::Torchvision => size.saturating_mul(long) / short,
            Self::Mmaction2 => (long as f64 * (size as f64 / short as f64) + 0.5) as usize,
            Self::PyTorchVideo => (long as f64 / short as f64 * size as f64) as usize,
        }
    }

    /// Where a crop of `crop` out of `size` starts so that it is in the middle.
    pub(super) fn middle(self, size: usize, crop: usize) -> usize {
        let rest = size - crop;
        match self {
            // Half to even.
            Self::Torchvision | Self::PyTorchVideo => rest / 2 + usize::from(rest % 4 == 3),
            Self::Mmaction2 => rest / 2,
        }
    }
}
