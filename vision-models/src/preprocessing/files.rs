//! Images and folders of images.

use std::{
    cmp::Ordering,
    fs,
    path::{Path, PathBuf},
};

use image::{ColorType, DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};
use ndarray::Array3;

use crate::{Error, file::read_bytes};

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
const EXTENSIONS: [&str; 3] = ["jpg", "jpeg", "png"];

/// Reads a JPEG or PNG file as height × width × 3 (red, green, blue). Grey becomes three equal
/// channels; transparency is left out.
///
/// # Errors
/// [`Error::File`] if it cannot be read or has more than 256 MiB; [`Error::Image`] as of
/// [`decode_image`].
pub fn read_image(path: impl AsRef<Path>) -> Result<Array3<u8>, Error> {
    let path = path.as_ref();
    decode_image(&read_bytes(path, MAX_FILE)?).map_err(|error| match error {
        Error::Image { reason, .. } => Error::Image { path: path.display().to_string(), reason },
        other => other,
    })
}

/// Decodes a JPEG or PNG file in memory; see [`read_image`].
///
/// A few kilobytes can claim gigabytes of pixels. What the header says is refused before memory is
/// taken for it: a side of more than 16,384 pixels, a PNG that takes more than 512 MiB (134
/// megapixels in grey, 178 in colour) and a JPEG that takes more than 1 GiB (119 megapixels in
/// colour).
///
/// # Errors
/// [`Error::Image`], with an empty path, for what is no such image or too large.
pub fn decode_image(bytes: &[u8]) -> Result<Array3<u8>, Error> {
    let refuse = |reason| Error::Image { path: String::new(), reason };
    let image = decode(bytes).map_err(refuse)?.into_rgb8();
    let (width, height) = image.dimensions();
    Array3::from_shape_vec((height as usize, width as usize, 3), image.into_raw())
        .map_err(|error| refuse(error.to_string()))
}

/// Decodes an image whose header claims no more than the limits above; else gives the reason.
fn decode(bytes: &[u8]) -> Result<DynamicImage, String> {
    let of_decoder = |error: ImageError| error.to_string();
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(MAX_METADATA);
    let reader = ImageReader::new(std::io::Cursor::new(bytes)).with_guessed_format();
    let mut reader = reader.map_err(|error| error.to_string())?;
    reader.limits(limits);
    let format = reader.format();
    let decoder = reader.into_decoder().map_err(of_decoder)?;

    let ((width, height), colour) = (decoder.dimensions(), decoder.color_type());
    let pixels = u64::from(width) * u64::from(height);
    let given = if colour == ColorType::Rgb8 { 0 } else { 3 * pixels };
    let coefficients = 2 * pixels * u64::from(colour.channel_count());
    let (taken, most) = match format {
        Some(ImageFormat::Jpeg) => (decoder.total_bytes() + given + coefficients, MAX_JPEG),
        _ => (decoder.total_bytes() + given, MAX_PNG),
    };
    if taken > most {
        let [taken, most] = [taken, most].map(|bytes| bytes >> 20);
        return Err(format!("{width} × {height} pixels take {taken} MiB, {most} MiB are accepted"));
    }
    DynamicImage::from_decoder(decoder).map_err(of_decoder)
}

/// The JPEG and PNG files of a folder, in the order of their names; numbers in the names count as
/// numbers, so that `frame_10` comes after `frame_9`.
///
/// # Errors
/// [`Error::File`] if the folder cannot be read, [`Error::NoFrames`] if it has no such files.
pub fn list_frames(folder: impl AsRef<Path>) -> Result<Vec<PathBuf>, Error> {
    let folder = folder.as_ref();
    let mut frames = Vec::new();
    for entry in fs::read_dir(folder).map_err(|error| of_file(folder, &error))? {
        let path = entry.map_err(|error| of_file(folder, &error))?.path();
        let extension = path.extension().and_then(|extension| extension.to_str());
        if extension.is_some_and(|own| EXTENSIONS.iter().any(|one| own.eq_ignore_ascii_case(one))) {
            frames.push(path);
        }
    }
    if frames.is_empty() {
        return Err(Error::NoFrames);
    }
    frames.sort_by(|one, other| {
        by_number(&one.to_string_lossy(), &other.to_string_lossy()).then_with(|| one.cmp(other))
    });
    Ok(frames)
}

/// Compares text, with runs of digits as the numbers that they are.
fn by_number(mut one: &str, mut other: &str) -> Ordering {
    loop {
        let (digits, others) = (number(one), number(other));
        let order = if digits.is_empty() || others.is_empty() {
            let order = one.chars().next().cmp(&other.chars().next());
            if order.is_ne() || one.is_empty() {
                return order;
            }
            one = skip(one, one.chars().next().map_or(0, char::len_utf8));
            other = skip(other, other.chars().next().map_or(0, char::len_utf8));
            order
        } else {
            let values = [digits, others].map(|digits| digits.trim_start_matches('0'));
            one = skip(one, digits.len());
            other = skip(other, others.len());
            values[0].len().cmp(&values[1].len()).then_with(|| values[0].cmp(values[1]))
        };
        if order.is_ne() {
            return order;
        }
    }
}

/// The digits at the start.
fn number(text: &str) -> &str {
    let end = text.find(|character: char| !character.is_ascii_digit()).unwrap_or(text.len());
    text.get(..end).unwrap_or_default()
}

fn skip(text: &str, bytes: usize) -> &str {
    text.get(bytes..).unwrap_or_default()
}

fn of_file(path: &Path, error: &std::io::Error) -> Error {
    Error::File { path: path.display().to_string(), reason: error.to_string() }
}

#[cfg(test)]
mod tests {
    use super::by_number;

    #[test]
    fn numbers_count_as_numbers() {
        let mut names = ["f10.png", "f9.png", "f009a.png", "g1", "f", "", "f09.png", "10", "9"];
        names.sort_by(|one, other| by_number(one, other));
        assert_eq!(names, ["", "9", "10", "f", "f9.png", "f09.png", "f009a.png", "f10.png", "g1"]);
    }
}
