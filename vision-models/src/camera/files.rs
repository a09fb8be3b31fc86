//! Depth images in files.

use std::{io::Cursor, path::Path};

use image::{ColorType, DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};

use super::depth_image::{DepthImage, check_scale};
use crate::error::Error;
use crate::file::{in_file, read_bytes};

/// Longest side of an image that is read (pixels).
const MAX_SIDE: u32 = 16_384;
/// Largest number of pixels.
const MAX_PIXELS: u64 = 64 << 20;
/// Largest memory for a file's contents other than pixels (bytes).
const MAX_METADATA: u64 = 16 << 20;
/// Largest file (bytes).
const MAX_FILE: u64 = 256 << 20;

/// Reads a grey PNG of 16 bits per pixel, whose numbers are multiples of `scale` metres. 0 is not
/// measured.
///
/// # Errors
/// - [`Error::File`] if it cannot be read or has more than 256 MiB.
/// - [`Error::Image`] if it is not such a PNG or has more than 64 megapixels.
/// - [`Error::Value`] if the scale is outside [1e-6, 1] m.
pub fn read_depth(path: impl AsRef<Path>, scale: f64) -> Result<DepthImage, Error> {
    check_scale(scale)?;
    let path = path.as_ref();
    decode_depth(&read_bytes(path, MAX_FILE).map_err(in_file(path))?, scale).map_err(|error| {
        match error {
            Error::Image { reason, .. } => {
                Error::Image { path: path.display().to_string(), reason }
            }
            other => other,
        }
    })
}

/// Decodes a depth image from the bytes of a PNG file, as [`read_depth`] does. Takes at most 512
/// MiB of memory.
///
/// # Errors
/// - [`Error::Image`] if it is not such a PNG or has more than 64 megapixels.
/// - [`Error::Value`] if the scale is outside [1e-6, 1] m.
pub fn decode_depth(bytes: &[u8], scale: f64) -> Result<DepthImage, Error> {
    check_scale(scale)?;
    let refuse = |reason| Error::Image { path: String::new(), reason };
    let (size, units) = decode(bytes).map_err(refuse)?;
    DepthImage::from_units(size, &units, scale)
}

/// Returns width and height, and the numbers row by row, or the reason for failing.
fn decode(bytes: &[u8]) -> Result<([usize; 2], Vec<u16>), String> {
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(MAX_METADATA);
    let mut reader = ImageReader::with_format(Cursor::new(bytes), ImageFormat::Png);
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(|error| error.to_string())?;
    let (width, height) = decoder.dimensions();
    if u64::from(width) * u64::from(height) > MAX_PIXELS {
        return Err(format!("{width} × {height} pixels, at most {MAX_PIXELS} are accepted"));
    }
    if decoder.color_type() != ColorType::L16 {
        return Err(format!(
            "its pixels are {:?}, and depth is one channel of 16 bits",
            decoder.color_type()
        ));
    }
    let image = DynamicImage::from_decoder(decoder).map_err(|error| error.to_string())?;
    Ok(([width as usize, height as usize], image.into_luma16().into_raw()))
}
