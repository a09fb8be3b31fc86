//! The box around a person in an image.

use crate::error::Error;

/// The rectangle around a person, in pixels. The centre of the pixel at the top left is at 0, 0.
///
/// ```
/// use vision_models::PersonBox;
///
/// let person = PersonBox { left: 200.0, top: 80.0, width: 120.0, height: 340.0 };
/// assert!(person.validate().is_ok());
/// assert!(PersonBox { width: 0.0, ..person }.validate().is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PersonBox {
    /// The left edge.
    pub left: f64,
    /// The upper edge.
    pub top: f64,
    /// Width, from left to right.
    pub width: f64,
    /// Height, from top to bottom.
    pub height: f64,
}

impl PersonBox {
    /// Largest size and distance of a box (pixels).
    const MAX_PIXELS: f64 = 1e6;

    /// Checks the numbers.
    ///
    /// # Errors
    /// [`Error::Value`] if a number is not finite or above a million, or the box has no area.
    pub fn validate(&self) -> Result<(), Error> {
        let Self { left, top, width, height } = *self;
        let near =
            [left, top, width, height].into_iter().all(|value| value.abs() <= Self::MAX_PIXELS);
        if near && width > 0.0 && height > 0.0 {
            return Ok(());
        }
        Err(self.refused("finite numbers of at most a million pixels, width and height above zero"))
    }

    pub(super) fn refused(&self, expected: &str) -> Error {
        let Self { left, top, width, height } = *self;
        let got = format!("at {left}, {top} of {width} × {height} pixels");
        Error::value("a person's box", got, expected)
    }

    /// Returns true if a part of the box lies in an image with this number of rows and columns.
    pub(super) fn overlaps(&self, [height, width]: [usize; 2]) -> bool {
        let Self { left, top, .. } = *self;
        left < width as f64
            && top < height as f64
            && left + self.width > 0.0
            && top + self.height > 0.0
    }
}
