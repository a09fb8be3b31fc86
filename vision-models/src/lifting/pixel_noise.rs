//! Errors of a network's joints in an image.

use crate::body::ImageBody;
use crate::error::Error;

/// The standard deviation of a joint in an image, each axis: a constant, and a part of the body's size there, since
/// networks see everybody at the same size.
///
/// ```
/// use vision_models::PixelNoise;
///
/// assert!(PixelNoise::default().validate().is_ok());
/// assert!(PixelNoise { constant: -1.0, share: 0.0 }.validate().is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelNoise {
    /// Error at size zero (pixels).
    pub constant: f64,
    /// Growth with the diagonal of what is seen of the body.
    pub share: f64,
}

impl Default for PixelNoise {
    /// Returns the noise of BlazePose.
    fn default() -> Self {
        Self { constant: 1.0, share: 0.016 }
    }
}

impl PixelNoise {
    /// Returns the standard deviation of the joints of a body, on each axis (pixels).
    pub fn sigma(&self, body: &ImageBody) -> f64 {
        self.constant + self.share * body.size().unwrap_or_default()
    }

    /// Checks every field.
    ///
    /// # Errors
    /// [`Error::Value`].
    pub fn validate(&self) -> Result<(), Error> {
        let Self { constant, share } = *self;
        if !(0.01..=1e3).contains(&constant) {
            return Err(Error::value("constant", constant, "0.01 to 1000 pixels"));
        }
        if !(0.0..=0.5).contains(&share) {
            return Err(Error::value("share", share, "0 to 0.5"));
        }
        Ok(())
    }
}
