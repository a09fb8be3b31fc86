//! Reads images from files.

use std::path::Path;

use image::{ColorType, DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};
use ndarray::Array3;

use super::jpeg;
use crate::error::Error;
use crate::file::{in_file, read_bytes};

/// Longest side of an image that is read (pixels).
const MAX_SIDE: u32 = 16_384;
/// Largest memory for the pixels of a PNG, both decoded and as returned (bytes).
const MAX_PNG: u64 = 512 << 20;
/// Largest memory for the pixels of a JPEG, with the coefficients that the decoder may keep
/// (bytes).
const MAX_JPEG: u64 = 1 << 30;
/// Largest memory for a file's contents other than pixels, such as colour profiles (bytes).
const MAX_METADATA: u64 = 16 << 20;
/// Largest image file that is read (bytes).
const MAX_FILE: u64 = 256 << 20;

/// The orientation in which the pixels of an image file are returned.
///
/// A camera that is held upright stores its pixels sideways and its orientation in the EXIF data.
/// Pillow and torchvision return the pixels as stored. OpenCV rotates them. Data that belong to the
/// camera's pixels, such as depth and joints, refer to the stored orientation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Orientation {
    /// The stored orientation.
    #[default]
    Stored,
    /// The orientation of the EXIF data, or the stored one if they give none.
    Exif,
}

/// Reads a JPEG or PNG file as height × width × 3 (red, green, blue), its pixels as stored. Grey
/// becomes three equal channels. Transparency is ignored.
///
/// # Errors
/// [`Error::File`] if it cannot be read or has more than 256 MiB, and those of [`decode_image`].
pub fn read_image(path: impl AsRef<Path>) -> Result<Array3<u8>, Error> {
    read_image_oriented(path, Orientation::Stored)
}

/// Reads an image as [`read_image`] does, in a given orientation.
///
/// # Errors
/// Those of [`read_image`].
pub fn read_image_oriented(
    path: impl AsRef<Path>,
    orientation: Orientation,
) -> Result<Array3<u8>, Error> {
    let path = path.as_ref();
    decode_image_oriented(&read_bytes(path, MAX_FILE).map_err(in_file(path))?, orientation).map_err(
        |error| match error {
            Error::Image { reason, .. } => {
                Error::Image { path: path.display().to_string(), reason }
            }
            other => other,
        },
    )
}

/// Decodes a JPEG or PNG file in memory; see [`read_image`].
///
/// A few kilobytes can claim gigabytes of pixels. Images are rejected by their header before memory
/// is allocated:
/// - a side of more than 16,384 pixels
/// - a PNG that needs more than 512 MiB (134 megapixels in grey, 178 in colour)
/// - a JPEG that needs more than 1 GiB (119 megapixels in colour)
///
/// # Errors
/// [`Error::Image`], with an empty path, if the bytes are no such image, or are too large,
/// truncated or corrupted. Missing pixels are never invented.
pub fn decode_image(bytes: &[u8]) -> Result<Array3<u8>, Error> {
    decode_image_oriented(bytes, Orientation::Stored)
}

/// Decodes an image as [`decode_image`] does, in a given orientation.
///
/// # Errors
/// Those of [`decode_image`].
pub fn decode_image_oriented(bytes: &[u8], orientation: Orientation) -> Result<Array3<u8>, Error> {
    let refuse = |reason| Error::Image { path: String::new(), reason };
    let image = decode(bytes, orientation).map_err(refuse)?.into_rgb8();
    let (width, height) = image.dimensions();
    Array3::from_shape_vec((height as usize, width as usize, 3), image.into_raw())
        .map_err(|error| refuse(error.to_string()))
}

/// Decodes an image whose header is within the limits above, or returns the reason for rejecting
/// it.
fn decode(bytes: &[u8], orientation: Orientation) -> Result<DynamicImage, String> {
    let of_decoder = |error: ImageError| error.to_string();
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(MAX_METADATA);
    let reader = ImageReader::new(std::io::Cursor::new(bytes)).with_guessed_format();
    let mut reader = reader.map_err(|error| error.to_string())?;
    reader.limits(limits);
    let format = reader.format();
    let mut decoder = reader.into_decoder().map_err(of_decoder)?;

    let ((width, height), colour) = (decoder.dimensions(), decoder.color_type());
    let pixels = u64::from(width) * u64::from(height);
    let turn = match orientation {
        Orientation::Stored => None,
        Orientation::Exif => Some(decoder.orientation().map_err(of_decoder)?),
    };
    let copies = u64::from(colour != ColorType::Rgb8) + u64::from(turn.is_some());
    let given = 3 * pixels * copies;
    let coefficients = 2 * pixels * u64::from(colour.channel_count());
    let (taken, most) = match format {
        Some(ImageFormat::Jpeg) => (decoder.total_bytes() + given + coefficients, MAX_JPEG),
        _ => (decoder.total_bytes() + given, MAX_PNG),
    };
    if taken > most {
        let [taken, most] = [taken, most].map(|bytes| bytes >> 20);
        return Err(format!("{width} × {height} pixels take {taken} MiB, {most} MiB are accepted"));
    }
    let mut image = match format {
        Some(ImageFormat::Jpeg) => jpeg::decode(bytes, (width, height), colour)?,
        _ => DynamicImage::from_decoder(decoder).map_err(of_decoder)?,
    };
    if let Some(turn) = turn {
        image.apply_orientation(turn);
    }
    Ok(image)
}
