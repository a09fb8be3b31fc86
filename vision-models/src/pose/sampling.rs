//! Parts of an image, scaled to a network's input.

use ndarray::{ArrayView3, ArrayViewMut3};

use crate::error::Error;

/// A scaled and moved copy of an image: the source of the pixel at column u and row v is at
/// x = `left` + `step` u, y = `top` + `step` v.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scaling {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) step: f64,
}

impl Scaling {
    /// Returns the image position of a position in the copy.
    pub(super) fn source(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        [self.left + self.step * u, self.top + self.step * v]
    }

    /// Fills channels × rows × columns with the image's colours, interpolated linearly and rounded
    /// to integer levels. `outside` is the level outside the image. `normalise(channel, level)`
    /// returns the value of the `channel`-th colour. Colour 0 is red.
    pub(super) fn sample(
        &self,
        image: &ArrayView3<'_, u8>,
        outside: f64,
        normalise: impl Fn(usize, f64) -> f32,
        mut target: ArrayViewMut3<'_, f32>,
    ) {
        for ((channel, row, column), value) in target.indexed_iter_mut() {
            let [x, y] = self.source([column as f64, row as f64]);
            *value = normalise(channel, bilinear(image, channel, [x, y], outside).round());
        }
    }
}

/// Returns the colour at a position between pixels.
fn bilinear(image: &ArrayView3<'_, u8>, channel: usize, [x, y]: [f64; 2], outside: f64) -> f64 {
    let (left, top) = (x.floor(), y.floor());
    let level = |row: f64, column: f64| {
        if row < 0.0 || column < 0.0 {
            return outside;
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "not negative; casts saturate"
        )]
        let at = [row as usize, column as usize, channel];
        image.get(at).map_or(outside, |&level| f64::from(level))
    };
    let (right, down) = (x - left, y - top);
    let mix = |row| (1.0 - right) * level(row, left) + right * level(row, left + 1.0);
    (1.0 - down) * mix(top) + down * mix(top + 1.0)
}

/// Checks that an image has three colours and at least one pixel.
///
/// # Errors
/// [`Error::Size`] if it has not.
pub(super) fn check_image(image: &ArrayView3<'_, u8>) -> Result<[usize; 2], Error> {
    let (rows, columns, colours) = image.dim();
    if rows > 0 && columns > 0 && colours == 3 {
        return Ok([rows, columns]);
    }
    let expected = "height x width x 3, red, green and blue, with at least one pixel";
    Err(Error::size("a frame", image.shape(), "values", expected))
}
