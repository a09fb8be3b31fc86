//! Colour and depth images.

use human_perception::frames::ColourImage;

/// A colour image with the depth of each pixel.
#[derive(Clone, Debug)]
pub struct RenderedImage {
    pub(super) size: [usize; 2],
    /// Red, green and blue, by rows.
    pub(super) colour: Vec<u8>,
    /// Depth \[m\]; infinite without a surface.
    pub(super) depth: Vec<f32>,
}

impl RenderedImage {
    /// Width and height (pixels).
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// The depth at a pixel \[m\]; infinite without a surface and outside the image.
    pub(crate) fn depth_at(&self, column: usize, row: usize) -> f32 {
        let [width, _] = self.size;
        let inside = column < width;
        let depth = self.depth.get(row * width + column).filter(|_| inside);
        depth.copied().unwrap_or(f32::INFINITY)
    }

    /// The colours.
    pub fn colours(&self) -> ColourImage<'_> {
        ColourImage { size: self.size, pixels: &self.colour }
    }
}
