//! Colour and depth images of the same moment.

use std::collections::VecDeque;
use std::time::SystemTime;

use ndarray::Array3;
use vision_models::{DepthImage, Intrinsics};

use super::messages::{CameraInfo, Image, Time};
use super::pictures::{check_pixels, colour_of, depth_of, intrinsics_of, size_of};
use super::refusal::Refusal;
use super::stamps::Stamps;

/// Largest difference of the stamps of two images of one moment \[s\].
const APART: f64 = 0.01;
/// Number of images that wait for their other half.
const WAITING: usize = 4;

/// Images of a moment.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraImages {
    /// Time of the colour image.
    pub stamp: Time,
    /// Colour image: height × width × 3 (red, green, blue).
    pub colour: Array3<u8>,
    /// Depth image, aligned to it.
    pub depth: DepthImage,
}

/// Joins the images of a camera: each colour image with the depth image of the same moment, 10 ms apart at most.
///
/// Images of another size than the camera's are refused, and so are all images before its information has come.
#[derive(Clone, Debug)]
pub struct FramePairs {
    intrinsics: Option<Intrinsics>,
    colours: VecDeque<(Time, Array3<u8>)>,
    depths: VecDeque<(Time, DepthImage)>,
    stamps: [Stamps; 2],
    unpaired: u64,
}

impl Default for FramePairs {
    fn default() -> Self {
        Self {
            intrinsics: None,
            colours: VecDeque::with_capacity(WAITING + 1),
            depths: VecDeque::with_capacity(WAITING + 1),
            stamps: [Stamps::of_camera(); 2],
            unpaired: 0,
        }
    }
}

impl FramePairs {
    /// Returns the camera's geometry, once it is known.
    pub fn intrinsics(&self) -> Option<Intrinsics> {
        self.intrinsics
    }

    /// Returns the number of images whose other half never came.
    pub fn unpaired(&self) -> u64 {
        self.unpaired
    }

    /// Takes the camera's geometry.
    ///
    /// # Errors
    /// Those of [`intrinsics_of`], and [`Refusal::OtherCamera`] for another geometry than before.
    pub fn take_info(&mut self, info: &CameraInfo) -> Result<(), Refusal> {
        let intrinsics = intrinsics_of(info)?;
        if *self.intrinsics.get_or_insert(intrinsics) == intrinsics {
            Ok(())
        } else {
            Err(Refusal::OtherCamera)
        }
    }

    /// Takes a colour image that came at time `now`. Returns its age \[s\], and the images of a moment that it completes.
    ///
    /// # Errors
    /// Why the image is refused.
    pub fn take_colour(
        &mut self,
        image: &Image,
        now: SystemTime,
    ) -> Result<(f64, Option<CameraImages>), Refusal> {
        self.check(image)?;
        let colour = colour_of(image)?;
        let [stamps, _] = &mut self.stamps;
        let age = stamps.admit(image.header.stamp, now)?;
        self.colours.push_back((image.header.stamp, colour));
        self.unpaired += shorten(&mut self.colours);
        Ok((age, self.join()))
    }

    /// Takes a depth image that came at time `now`. Returns its age \[s\], and the images of a moment that it completes.
    ///
    /// # Errors
    /// Why the image is refused.
    pub fn take_depth(
        &mut self,
        image: &Image,
        now: SystemTime,
    ) -> Result<(f64, Option<CameraImages>), Refusal> {
        self.check(image)?;
        let depth = depth_of(image)?;
        let [_, stamps] = &mut self.stamps;
        let age = stamps.admit(image.header.stamp, now)?;
        self.depths.push_back((image.header.stamp, depth));
        self.unpaired += shorten(&mut self.depths);
        Ok((age, self.join()))
    }

    fn check(&self, image: &Image) -> Result<(), Refusal> {
        check_pixels(size_of(image), self.intrinsics.ok_or(Refusal::NoCamera)?.size())
    }

    /// Returns the newest two images that belong together, and drops older ones.
    fn join(&mut self) -> Option<CameraImages> {
        let (colour, depth) =
            self.colours.iter().enumerate().rev().find_map(|(index, colour)| {
                let apart = |(depth, _): &(Time, DepthImage)| colour.0.seconds_since(*depth).abs();
                let same = self.depths.iter().rposition(|depth| apart(depth) <= APART)?;
                Some((index, same))
            })?;
        self.unpaired += (colour + depth) as u64;
        let (stamp, colour) = self.colours.drain(..=colour).next_back()?;
        let (_, depth) = self.depths.drain(..=depth).next_back()?;
        Some(CameraImages { stamp, colour, depth })
    }
}

/// Drops the oldest image if too many wait. Returns the number of dropped images.
fn shorten<T>(images: &mut VecDeque<T>) -> u64 {
    if images.len() <= WAITING {
        return 0;
    }
    images.pop_front().map_or(0, |_| 1)
}
