//! Colour and depth.

use std::io::Cursor;

use image::{
    ExtendedColorType, ImageEncoder,
    codecs::png::{CompressionType, FilterType, PngEncoder},
};
use vision_models::{DepthImage, Error};

/// A colour image with the depth of each pixel.
#[derive(Clone, Debug)]
pub struct RenderedImage {
    pub(super) size: [usize; 2],
    /// Red, green, blue, row after row.
    pub(super) colour: Vec<u8>,
    /// In metres; infinite where nothing is.
    pub(super) depth: Vec<f32>,
}

impl RenderedImage {
    /// Width and height (pixels).
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// The depth at a pixel (m), infinite where nothing is and outside the image.
    pub fn depth_at(&self, column: usize, row: usize) -> f32 {
        let [width, _] = self.size;
        let inside = column < width;
        let depth = self.depth.get(row * width + column).filter(|_| inside);
        depth.copied().unwrap_or(f32::INFINITY)
    }

    /// The depths without any noise.
    ///
    /// # Errors
    /// None for an image that was rendered.
    pub fn depth_image(&self) -> Result<DepthImage, Error> {
        DepthImage::from_metres(self.size, self.depth.clone())
    }

    /// The colours as a PNG file.
    ///
    /// # Errors
    /// What the encoder says.
    pub fn colour_png(&self) -> Result<Vec<u8>, image::ImageError> {
        png(&self.colour, self.size, ExtendedColorType::Rgb8)
    }
}

/// Depths as a PNG file of 16 bits a pixel, in millimetres; 0 where there is none.
///
/// # Errors
/// What the encoder says.
pub fn depth_png(depth: &DepthImage) -> Result<Vec<u8>, image::ImageError> {
    let bytes: Vec<u8> = depth
        .depths()
        .iter()
        .flat_map(|&metres| {
            let millimetres = (1e3 * metres).round().clamp(0.0, f32::from(u16::MAX));
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
            let millimetres = millimetres as u16;
            // The encoder takes the machine's order.
            millimetres.to_ne_bytes()
        })
        .collect();
    png(&bytes, depth.size(), ExtendedColorType::L16)
}

fn png(
    bytes: &[u8],
    [width, height]: [usize; 2],
    colour: ExtendedColorType,
) -> Result<Vec<u8>, image::ImageError> {
    let mut file = Cursor::new(Vec::new());
    let side = |side: usize| u32::try_from(side).unwrap_or(u32::MAX);
    PngEncoder::new_with_quality(&mut file, CompressionType::Fast, FilterType::Sub).write_image(
        bytes,
        side(width),
        side(height),
        colour,
    )?;
    Ok(file.into_inner())
}
