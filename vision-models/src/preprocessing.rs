//! From camera frames to what a network was trained on.
#![allow(clippy::needless_pass_by_value)] // views go by value, as everywhere in ndarray

mod antialiased;
mod files;
mod folder;
mod interpolated;
mod jpeg;
mod library;
mod sampling;

use ndarray::{Array3, Array4, Array5, ArrayView3, Axis, s};

pub use files::{
    Orientation, decode_image, decode_image_oriented, read_image, read_image_oriented,
};
pub use folder::{ImageFolder, OtherFiles, is_hidden, list_frames};
pub use library::Library;
pub use sampling::ClipSampling;

use crate::error::Error;

/// The size that a frame is brought to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Resize {
    /// The short side gets this length, the long one follows (pixels).
    ShortSide(usize),
    /// Both sides get this length, whatever the frame's shape (pixels).
    Square(usize),
}

/// The parts of a frame that a network sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Crops {
    /// The middle.
    Centre,
    /// Both ends and the middle along the long side.
    Three,
    /// The corners and the middle, each also mirrored.
    Ten,
}

/// How frames are resized, cropped and normalised.
///
/// A frame is an array of height × width × 3 bytes (red, green, blue), of any size.
///
/// ```
/// use ndarray::Array3;
/// use vision_models::Preprocessing;
///
/// let frame = Array3::<u8>::zeros((480, 640, 3));
/// let images = Preprocessing::TORCHVISION.image(frame.view())?;
/// assert_eq!(images.dim(), (1, 3, 224, 224));
///
/// let frames = vec![frame.view(); 8];
/// let clips = Preprocessing::MMACTION2.clip(&frames)?;
/// assert_eq!(clips.dim(), (1, 3, 8, 256, 256));
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Preprocessing {
    /// Whose arithmetic is followed.
    pub library: Library,
    /// The size before the crop.
    pub resize: Resize,
    /// The side of the crop (pixels).
    pub crop: usize,
    /// Which crops are taken.
    pub crops: Crops,
}

impl Preprocessing {
    /// ImageNet's, with the paper's 255: short side 255, the middle 224 × 224. torchvision's own weights were measured
    /// with 256 (`IMAGENET1K_V1`) and 232 (`IMAGENET1K_V2`).
    pub const TORCHVISION: Self = Self {
        library: Library::Torchvision,
        resize: Resize::ShortSide(255),
        crop: 224,
        crops: Crops::Centre,
    };
    /// The paper's for surfaces, to the letter (Experiment 1): 255 × 255, the middle 224 × 224.
    pub const SURFACE: Self = Self { resize: Resize::Square(255), ..Self::TORCHVISION };
    /// mmaction2's for SlowOnly: short side 256, the middle 256 × 256.
    pub const MMACTION2: Self = Self {
        library: Library::Mmaction2,
        resize: Resize::ShortSide(256),
        crop: 256,
        crops: Crops::Centre,
    };
    /// PyTorchVideo's: short side 256, the middle 256 × 256.
    pub const PYTORCHVIDEO: Self = Self { library: Library::PyTorchVideo, ..Self::MMACTION2 };

    /// The crops of one frame, crops × 3 × side × side.
    ///
    /// # Errors
    /// [`Error::Size`] for a frame without pixels, with other than three channels or with a
    /// side above 16,384, before or after the resize, or smaller than the crop; [`Error::Value`]
    /// for a size that is not from 1 to 16,384.
    pub fn image(&self, frame: ArrayView3<'_, u8>) -> Result<Array4<f32>, Error> {
        Ok(self.clip(&[frame])?.index_axis_move(Axis(2), 0))
    }

    /// The crops of the frames of a clip, crops × 3 × frames × side × side.
    ///
    /// # Errors
    /// As of [`Self::image`]; [`Error::NoFrames`].
    pub fn clip(&self, frames: &[ArrayView3<'_, u8>]) -> Result<Array5<f32>, Error> {
        let Some((first, rest)) = frames.split_first() else {
            return Err(Error::NoFrames);
        };
        if let Some(other) = rest.iter().find(|frame| frame.dim() != first.dim()) {
            let expected = format!("as many as the clip's first frame has, {:?}", first.shape());
            return Err(Error::size("a frame", other.shape(), "values", &expected));
        }
        let (height, width) = self.size(first)?;
        let places = self.places(height, width)?;
        let (crops, side) = (places.len(), self.crop);
        let mut clips = Array5::zeros((crops, 3, frames.len(), side, side));
        for (index, frame) in frames.iter().enumerate() {
            let mut pixels = self.library.resize(frame.view(), height, width);
            self.normalise(&mut pixels);
            for (mut clip, place) in clips.outer_iter_mut().zip(&places) {
                let mut crop = pixels.slice(s![
                    place.top..place.top + side,
                    place.left..place.left + side,
                    ..
                ]);
                if place.mirrored {
                    crop.invert_axis(Axis(1));
                }
                clip.index_axis_mut(Axis(1), index).assign(&crop.permuted_axes([2, 0, 1]));
            }
        }
        Ok(clips)
    }

    /// The size of a frame after the resize: height, width.
    fn size(&self, frame: &ArrayView3<'_, u8>) -> Result<(usize, usize), Error> {
        check_frame(frame)?;
        let (height, width, _) = frame.dim();
        let (Resize::ShortSide(side) | Resize::Square(side)) = self.resize;
        check_sides([("resize", side), ("crop", self.crop)])?;
        let size = match self.resize {
            Resize::Square(side) => (side, side),
            Resize::ShortSide(side) if height <= width => {
                (side, self.library.long_side(width, height, side))
            }
            Resize::ShortSide(side) => (self.library.long_side(height, width, side), side),
        };
        if size.0.max(size.1) > MAX_SIDE {
            let expected = "a shape of which no side becomes longer than 16,384 pixels";
            return Err(Error::size("a frame", frame.shape(), "values", expected));
        }
        Ok(size)
    }

    /// Where the crops are, in the order of mmaction2.
    fn places(&self, height: usize, width: usize) -> Result<Vec<Place>, Error> {
        let crop = self.crop;
        if crop > height.min(width) {
            let expected = format!("at least {crop} × {crop} for the crop");
            return Err(Error::size("the resized frame", &[height, width], "pixels", &expected));
        }
        let place = |top, left| Place { top, left, mirrored: false };
        let (down, right) = (height - crop, width - crop);
        Ok(match self.crops {
            Crops::Centre => {
                let middle = |size| self.library.middle(size, crop);
                vec![place(middle(height), middle(width))]
            }
            Crops::Three => {
                let (down, right) = (down / 2, right / 2);
                vec![place(0, 0), place(2 * down, 2 * right), place(down, right)]
            }
            Crops::Ten => {
                let (down, right) = (down / 4, right / 4);
                [(0, 0), (0, 4), (4, 0), (4, 4), (2, 2)]
                    .into_iter()
                    .map(|(rows, columns)| place(rows * down, columns * right))
                    .flat_map(|place| [place, Place { mirrored: true, ..place }])
                    .collect()
            }
        })
    }

    fn normalise(&self, pixels: &mut Array3<f32>) {
        let [mean, deviation] = self.library.normalisation();
        let scale = 255.0 / self.library.white();
        for ((mut plane, mean), deviation) in pixels.axis_iter_mut(Axis(2)).zip(mean).zip(deviation)
        {
            plane.mapv_inplace(|pixel| (pixel / scale - mean) / deviation);
        }
    }
}

/// Resizes an image, height × width × 3, with Pillow's bilinear filter, which antialiases
/// (`Image.resize(…, Image.BILINEAR)`): every byte is the same as with Pillow up to version 12.
/// Version 13 differs, by one at some pixels, when the height shrinks by more than twice as many
/// pixels as the width.
///
/// # Errors
/// [`Error::Size`] for a frame without pixels or with other than three channels,
/// [`Error::Value`] for a side that is not from 1 to 16,384.
pub fn resize_pillow(
    frame: ArrayView3<'_, u8>,
    height: usize,
    width: usize,
) -> Result<Array3<u8>, Error> {
    check_resize(&frame, height, width)?;
    Ok(antialiased::resize(frame, height, width))
}

/// Resizes an image, height × width × 3, with OpenCV's bilinear interpolation, which does not
/// antialias (`cv2.resize(…, interpolation=cv2.INTER_LINEAR)`): every byte is the same.
///
/// # Errors
/// As of [`resize_pillow`].
pub fn resize_opencv(
    frame: ArrayView3<'_, u8>,
    height: usize,
    width: usize,
) -> Result<Array3<u8>, Error> {
    check_resize(&frame, height, width)?;
    Ok(interpolated::resize_opencv(frame, height, width))
}

/// The longest side of an image (pixels).
const MAX_SIDE: usize = 16_384;

fn check_resize(frame: &ArrayView3<'_, u8>, height: usize, width: usize) -> Result<(), Error> {
    check_frame(frame)?;
    check_sides([("height", height), ("width", width)])
}

fn check_frame(frame: &ArrayView3<'_, u8>) -> Result<(), Error> {
    let (height, width, channels) = frame.dim();
    if (1..=MAX_SIDE).contains(&height) && (1..=MAX_SIDE).contains(&width) && channels == 3 {
        return Ok(());
    }
    let expected = "height × width × 3, with sides from 1 to 16,384";
    Err(Error::size("a frame", frame.shape(), "values", expected))
}

fn check_sides(sides: [(&'static str, usize); 2]) -> Result<(), Error> {
    match sides.into_iter().find(|(_, side)| !(1..=MAX_SIDE).contains(side)) {
        Some((name, side)) => {
            let expected = "from 1 to 16,384 pixels";
            Err(Error::value(name, side, expected))
        }
        None => Ok(()),
    }
}

/// Where a crop starts.
#[derive(Clone, Copy, Debug)]
struct Place {
    top: usize,
    left: usize,
    mirrored: bool,
}
