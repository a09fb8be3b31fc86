//! Images in files.

use std::path::Path;

use image::{ColorType, DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};
use ndarray::Array3;

use super::jpeg;
use crate::error::Error;
use crate::file::{in_file, read_bytes};

/// The longest side of an image that is read (pixels).
const MAX_SIDE: u32 = 16_384;
/// The most memory that the pixels of a PNG may take, as decoded and as they are given (bytes).
const MAX_PNG: u64 = 512 << 20;
/// The same for a JPEG, with the coefficients, of which the decoder may keep all (bytes).
const MAX_JPEG: u64 = 1 << 30;
/// The most memory for what a file holds beside pixels, such as colour profiles (bytes).
const MAX_METADATA: u64 = 16 << 20;
/// The largest image file that is read (bytes).
const MAX_FILE: u64 = 256 << 20;

/// Which way up the pixels of an image file are given.
///
/// A camera that is held upright writes its pixels lying, and how it was held beside them, in the EXIF data. Pillow and
/// torchvision leave the pixels as they are stored, OpenCV turns them. What belongs to the pixels of a camera, such as
/// depth and joints, is as they are stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Orientation {
    /// As they are stored.
    #[default]
    Stored,
    /// As the EXIF data says; as they are stored where it says nothing.
    Exif,
}

/// Reads a JPEG or PNG file as height × width × 3 (red, green, blue), its pixels as they are stored. Grey becomes
/// three equal channels; transparency is left out.
///
/// # Errors
/// [`Error::File`] if it cannot be read or has more than 256 MiB; [`Error::Image`] as of
/// [`decode_image`].
pub fn read_image(path: impl AsRef<Path>) -> Result<Array3<u8>, Error> {
    read_image_oriented(path, Orientation::Stored)
}

/// The same with a choice which way up.
///
/// # Errors
/// As of [`read_image`].
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
/// A few kilobytes can claim gigabytes of pixels. What the header says is refused before memory is
/// taken for it: a side of more than 16,384 pixels, a PNG that takes more than 512 MiB (134
/// megapixels in grey, 178 in colour) and a JPEG that takes more than 1 GiB (119 megapixels in
/// colour).
///
/// # Errors
/// [`Error::Image`], with an empty path, for what is no such image, too large, cut off or corrupted: pixels that a
/// file does not have are not made up.
pub fn decode_image(bytes: &[u8]) -> Result<Array3<u8>, Error> {
    decode_image_oriented(bytes, Orientation::Stored)
}

/// The same with a choice which way up.
///
/// # Errors
/// As of [`decode_image`].
pub fn decode_image_oriented(bytes: &[u8], orientation: Orientation) -> Result<Array3<u8>, Error> {
    let refuse = |reason| Error::Image { path: String::new(), reason };
    let image = decode(bytes, orientation).map_err(refuse)?.into_rgb8();
    let (width, height) = image.dimensions();
    Array3::from_shape_vec((height as usize, width as usize, 3), image.into_raw())
        .map_err(|error| refuse(error.to_string()))
}

/// Decodes an image whose header claims no more than the limits above; else gives the reason.
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
