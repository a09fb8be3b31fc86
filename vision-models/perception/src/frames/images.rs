//! The images of one frame, in files or in memory.

use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::time::Instant;

use ndarray::Array3;
use vision_models::{DepthImage, read_image};

use super::format::FrameEntry;
use crate::error::Error;

/// A colour image: height × width × 3 (red, green, blue).
#[derive(Clone, Debug, PartialEq)]
pub enum Picture {
    /// A JPEG or PNG file.
    File(PathBuf),
    /// Pixels in memory.
    Pixels(Array3<u8>),
}

impl Picture {
    /// Returns the pixels. A file is read at each call.
    ///
    /// # Errors
    /// Names the file that cannot be read.
    pub fn read(&self) -> Result<Cow<'_, Array3<u8>>, Error> {
        Ok(match self {
            Self::File(path) => Cow::Owned(read_image(path)?),
            Self::Pixels(pixels) => Cow::Borrowed(pixels),
        })
    }

    /// Returns a name for errors.
    pub fn name(&self) -> &Path {
        match self {
            Self::File(path) => path,
            Self::Pixels(_) => Path::new("the image in memory"),
        }
    }
}

/// Images of a frame.
///
/// ```
/// use human_perception::frames::{FrameEntry, FrameImages, Picture};
/// use vision_models::{DepthImage, ndarray::Array3};
///
/// let entry = FrameEntry { frame: 1, time: 0.05, arrived: Some(0.06) };
/// let depth = DepthImage::from_metres([4, 3], vec![2.0; 12])?;
/// let images = FrameImages::new(entry, depth, Picture::Pixels(Array3::zeros((3, 4, 3))));
/// assert!(images.surface.is_none());
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct FrameImages {
    /// Number and times.
    pub entry: FrameEntry,
    /// Depth image, aligned to the colour image.
    pub depth: DepthImage,
    /// Colour image.
    pub colour: Picture,
    /// Image of the on-board camera, which sees the object.
    pub surface: Option<Picture>,
    /// Moment at which the frame had arrived.
    pub(crate) arrived: Instant,
}

impl FrameImages {
    /// Creates the images of a frame that has just arrived.
    pub fn new(entry: FrameEntry, depth: DepthImage, colour: Picture) -> Self {
        Self { entry, depth, colour, surface: None, arrived: Instant::now() }
    }

    /// Sets the moment at which the frame had arrived.
    #[must_use]
    pub fn arrived_at(mut self, arrived: Instant) -> Self {
        self.arrived = arrived;
        self
    }
}
