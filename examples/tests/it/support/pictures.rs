//! Image files.

use std::path::Path;

use image::{ImageFormat, RgbImage};

/// A picture of 40 × 30 pixels around a grey level, with a texture that depends on `seed`.
fn picture(level: u8, seed: u32) -> RgbImage {
    RgbImage::from_fn(40, 30, |x, y| {
        let texture = |channel: u32| {
            let noise = (x * 31 + y * 17 + channel * 5 + seed * 7) % 23;
            level.saturating_add(u8::try_from(noise).unwrap())
        };
        image::Rgb([0, 1, 2].map(texture))
    })
}

/// Writes such a picture.
pub(crate) fn save_picture(path: &Path, level: u8, seed: u32) -> String {
    picture(level, seed).save(path).unwrap();
    path.to_str().unwrap().to_owned()
}

/// A small PNG whose header claims this number of pixels in grey.
pub(crate) fn png_that_claims(width: u32, height: u32) -> Vec<u8> {
    let mut png = std::io::Cursor::new(Vec::new());
    RgbImage::new(1, 1).write_to(&mut png, ImageFormat::Png).unwrap();
    let mut png = png.into_inner();
    // The header chunk has its kind at 12, then width, height, depth, colour type, three bytes, and the checksum.
    png[16..20].copy_from_slice(&width.to_be_bytes());
    png[20..24].copy_from_slice(&height.to_be_bytes());
    (png[24], png[25]) = (8, 0);
    let checksum = crc32fast::hash(&png[12..29]);
    png[29..33].copy_from_slice(&checksum.to_be_bytes());
    png
}
