//! Converts camera frames to a network's input, as in its training.
#![allow(clippy::needless_pass_by_value)] // views are passed by value, as usual with ndarray

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

/// The size to which a frame is resized.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Resize {
    /// The short side gets this length (pixels). The long side keeps the proportions.
    ShortSide(usize),
    /// Both sides get this length, whatever the frame's proportions (pixels).
    Square(usize),
}

/// The crops of a frame that a network sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Crops {
    /// The centre crop.
    Centre,
    /// Crops at both ends and in the middle of the long side.
    Three,
    /// Crops at the corners and in the middle, each also mirrored.
    Ten,
}

/// Resizing, cropping and normalisation of frames.
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
    /// The library whose arithmetic is used.
    pub library: Library,
    /// Size before the crop.
    pub resize: Resize,
    /// Side of the crop (pixels).
    pub crop: usize,
    /// The crops that are taken.
    pub crops: Crops,
}

impl Preprocessing {
    /// ImageNet's preprocessing with the paper's 255: short side 255, centre crop 224 × 224.
    /// torchvision measured its own weights with 256 (`IMAGENET1K_V1`) and 232 (`IMAGENET1K_V2`).
    pub const TORCHVISION: Self = Self {
        library: Library::Torchvision,
        resize: Resize::ShortSide(255),
        crop: 224,
        crops: Crops::Centre,
    };
    /// The paper's preprocessing for surfaces (Experiment 1): 255 × 255, centre crop 224 × 224.
    pub const SURFACE: Self = Self { resize: Resize::Square(255), ..Self::TORCHVISION };
    /// mmaction2's preprocessing for SlowOnly: short side 256, centre crop 256 × 256.
    pub const MMACTION2: Self = Self {
        library: Library::Mmaction2,
        resize: Resize::ShortSide(256),
        crop: 256,
        crops: Crops::Centre,
    };
    /// PyTorchVideo's preprocessing: short side 256, centre crop 256 × 256.
    pub const PYTORCHVIDEO: Self = Self { library: Library::PyTorchVideo, ..Self::MMACTION2 };

    /// Returns the crops of one frame, crops × 3 × side × side.
    ///
    /// # Errors
    /// - [`Error::Size`] if the frame has no pixels or not three channels.
    /// - [`Error::Size`] if a side is above 16,384 before or after the resize, or smaller than the
    ///   crop.
    /// - [`Error::Value`] if a size in the settings is not from 1 to 16,384.
    pub fn image(&self, frame: ArrayView3<'_, u8>) -> Result<Array4<f32>, Error> {
        Ok(self.clip(&[frame])?.index_axis_move(Axis(2), 0))
    }

    /// Returns the crops of the frames of a clip, crops × 3 × frames × side × side.
    ///
    /// # Errors
    /// Those of [`Self::image`], and [`Error::NoFrames`] if the clip is empty.
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

    /// Returns the size of a frame after the resize: height, width.
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

    /// Returns the positions of the crops, in mmaction2's order.
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
/// (`Image.resize(…, Image.BILINEAR)`).
///
/// Up to version 12 of Pillow every byte is the same. Later versions differ by one at some pixels
/// if the height shrinks by more than twice as many pixels as the width. pixels as the width.
///
/// # Errors
/// - [`Error::Size`] if the frame has no pixels or not three channels.
/// - [`Error::Value`] if a side is not from 1 to 16,384.
pub fn resize_pillow(
    frame: ArrayView3<'_, u8>,
    height: usize,
    width: usize,
) -> Result<Array3<u8>, Error> {
    check_resize(&frame, height, width)?;
    Ok(antialiased::resize(frame, height, width))
}

/// Resizes an image, height × width × 3, with OpenCV's bilinear interpolation, which does not
/// antialias (`cv2.resize(…, interpolation=cv2.INTER_LINEAR)`). Every byte is the same.
///
/// # Errors
/// Those of [`resize_pillow`].
pub fn resize_opencv(
    frame: ArrayView3<'_, u8>,
    height: usize,
    width: usize,
) -> Result<Array3<u8>, Error> {
    check_resize(&frame, height, width)?;
    Ok(interpolated::resize_opencv(frame, height, width))
}

/// Longest side of an image (pixels).
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

/// The start of a crop.
#[derive(Clone, Copy, Debug)]
struct Place {
    top: usize,
    left: usize,
    mirrored: bool,
}
