//! Conversion of images and of the camera's geometry.

use nalgebra::{Point2, Vector2};
use ndarray::Array3;
use vision_models::{DepthImage, Distortion, Intrinsics};

use super::messages::{CameraInfo, Image};
use super::refusal::Refusal;

/// Largest distance by which a lens may move a pixel.
const BENT: f64 = 1.0;
/// Size of a unit of depth images of 16 bits \[m\].
const MILLIMETRE: f64 = 1e-3;

/// Returns the pixels of a colour image: height × width × 3 (red, green, blue).
///
/// ```
/// use moca_drivers::ros2::messages::Image;
/// use moca_drivers::ros2::colour_of;
///
/// let image = Image { height: 1, width: 1, encoding: "bgr8".into(), step: 3, data: vec![3, 2, 1], ..Image::default() };
/// assert_eq!(colour_of(&image)?.into_raw_vec_and_offset().0, [1, 2, 3]);
/// # Ok::<(), moca_drivers::ros2::Refusal>(())
/// ```
///
/// # Errors
/// [`Refusal::Encoding`], and [`Refusal::Size`] for a wrong number of bytes.
pub fn colour_of(image: &Image) -> Result<Array3<u8>, Refusal> {
    let (channels, [red, green, blue]) = match image.encoding.as_str() {
        "rgb8" => (3, [0, 1, 2]),
        "bgr8" => (3, [2, 1, 0]),
        "rgba8" => (4, [0, 1, 2]),
        "bgra8" => (4, [2, 1, 0]),
        "mono8" | "8UC1" => (1, [0, 0, 0]),
        found => {
            let expected = "rgb8, bgr8, rgba8, bgra8 or mono8";
            return Err(Refusal::Encoding { found: found.to_owned(), expected });
        }
    };
    let [width, height] = size_of(image);
    let rows = rows_of(image, channels)?;
    let mut pixels = Vec::with_capacity(3 * width * height);
    for row in rows {
        if channels == 3 && red == 0 {
            pixels.extend_from_slice(row);
            continue;
        }
        for pixel in row.chunks_exact(channels) {
            pixels.extend([red, green, blue].map(|of| pixel.get(of).copied().unwrap_or_default()));
        }
    }
    Array3::from_shape_vec((height, width, 3), pixels)
        .map_err(|error| Refusal::Camera(error.to_string()))
}

/// Returns the depths of a depth image: `16UC1` in millimetres or `32FC1` in metres.
///
/// # Errors
/// [`Refusal::Encoding`], [`Refusal::Size`] for a wrong number of bytes, and [`Refusal::Camera`] for an empty image.
pub fn depth_of(image: &Image) -> Result<DepthImage, Refusal> {
    let size = size_of(image);
    let big = image.is_bigendian != 0;
    let empty = |error: vision_models::Error| Refusal::Camera(error.to_string());
    match image.encoding.as_str() {
        "16UC1" | "mono16" => {
            let unit = |bytes: &[u8; 2]| {
                if big { u16::from_be_bytes(*bytes) } else { u16::from_le_bytes(*bytes) }
            };
            let rows = rows_of(image, 2)?;
            let units: Vec<_> = rows.flat_map(|row| row.as_chunks().0.iter().map(unit)).collect();
            DepthImage::from_units(size, &units, MILLIMETRE).map_err(empty)
        }
        "32FC1" => {
            let metres = |bytes: &[u8; 4]| {
                if big { f32::from_be_bytes(*bytes) } else { f32::from_le_bytes(*bytes) }
            };
            let rows = rows_of(image, 4)?;
            let depths = rows.flat_map(|row| row.as_chunks().0.iter().map(metres)).collect();
            DepthImage::from_metres(size, depths).map_err(empty)
        }
        found => {
            let expected = "16UC1 or 32FC1";
            Err(Refusal::Encoding { found: found.to_owned(), expected })
        }
    }
}

/// Returns the pinhole model of a camera whose images are rectified, or nearly so.
///
/// # Errors
/// [`Refusal::Camera`] for numbers that are no camera's, and [`Refusal::Lens`] for a lens that moves pixels of the border
/// by more than one.
pub fn intrinsics_of(info: &CameraInfo) -> Result<Intrinsics, Refusal> {
    let CameraInfo { width, height, d, k: [fx, _, cx, _, fy, cy, ..], .. } = info;
    let [width, height] = [*width, *height].map(|side| side as usize);
    let intrinsics = Intrinsics::new([width, height], [*fx, *fy], [*cx, *cy])
        .map_err(|error| Refusal::Camera(error.to_string()))?;
    let lens = lens_of(&info.distortion_model, d)?;
    let [right, bottom] = [width, height].map(|side| side.saturating_sub(1) as f64);
    let border = [0.0, 0.5, 1.0].map(|share| share * right).into_iter().flat_map(|column| {
        [0.0, 0.5, 1.0].map(|share| share * bottom).map(|row| Point2::new(column, row))
    });
    let focal = Vector2::new(*fx, *fy);
    let bent = border.map(|pixel| {
        let ray = Point2::from(intrinsics.ray(&pixel).xy());
        (lens.distort(&ray) - ray).component_mul(&focal).norm()
    });
    let pixels = bent.fold(0.0, f64::max);
    if pixels <= BENT { Ok(intrinsics) } else { Err(Refusal::Lens { pixels }) }
}

/// Returns the lens of this model with these coefficients.
fn lens_of(model: &str, coefficients: &[f64]) -> Result<Distortion, Refusal> {
    if coefficients.iter().all(|coefficient| *coefficient == 0.0) {
        return Ok(Distortion::None);
    }
    if !coefficients.iter().all(|coefficient| coefficient.is_finite()) {
        return Err(Refusal::NotFinite { what: "distortion" });
    }
    match (model, coefficients) {
        ("plumb_bob" | "rational_polynomial", &[k1, k2, p1, p2, ref rest @ ..])
            if rest.len() <= 4 =>
        {
            let further = |index: usize| rest.get(index).copied().unwrap_or_default();
            let [k3, k4, k5, k6] = [0, 1, 2, 3].map(further);
            Ok(Distortion::Radial([k1, k2, p1, p2, k3, k4, k5, k6]))
        }
        ("equidistant" | "fisheye", &[k1, k2, k3, k4]) => Ok(Distortion::Fisheye([k1, k2, k3, k4])),
        _ => Err(Refusal::Camera(format!(
            "the lens {model:?} with {} coefficients is unknown",
            coefficients.len()
        ))),
    }
}

/// Returns width and height.
pub(super) fn size_of(image: &Image) -> [usize; 2] {
    [image.width, image.height].map(|side| side as usize)
}

/// Returns the bytes of each row, without those that fill it up.
fn rows_of(image: &Image, bytes: usize) -> Result<impl Iterator<Item = &[u8]>, Refusal> {
    let [width, height] = size_of(image);
    let (step, length) = (image.step as usize, bytes.saturating_mul(width));
    if step < length || length == 0 {
        return Err(Refusal::Size { what: "a row's bytes", found: step, expected: length });
    }
    let (found, expected) = (image.data.len(), step.saturating_mul(height));
    if found != expected {
        return Err(Refusal::Size { what: "image bytes", found, expected });
    }
    Ok(image.data.chunks_exact(step).map(move |row| row.get(..length).unwrap_or_default()))
}

/// Checks that an image has the size of the camera's images.
pub(super) fn check_pixels(found: [usize; 2], expected: [usize; 2]) -> Result<(), Refusal> {
    if found == expected { Ok(()) } else { Err(Refusal::Pixels { found, expected }) }
}
