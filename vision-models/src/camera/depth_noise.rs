//! The noise of a depth camera.

use crate::error::Error;

/// Noise of a stereo depth camera: the standard deviation of a depth z is `constant` + `quadratic`
/// · z².
///
/// A disparity error of s pixels at focal length f (pixels) and baseline B (m) gives z² s / (f B).
///
/// ```
/// use vision_models::DepthNoise;
///
/// let sigma = DepthNoise::D435I.sigma(3.0);
/// assert!((sigma - 0.038).abs() < 0.002);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthNoise {
    /// Standard deviation at distance zero (m).
    pub constant: f64,
    /// Growth with the square of the distance (1/m).
    pub quadratic: f64,
}

impl DepthNoise {
    /// An Intel `RealSense` D435i at 640 × 480: s = 0.08 px, f = 385 px, B = 50 mm.
    pub const D435I: Self = Self { constant: 0.001, quadratic: 0.08 / (385.0 * 0.05) };

    /// Returns the standard deviation of a depth (m).
    pub fn sigma(&self, depth: f64) -> f64 {
        self.constant + self.quadratic * depth * depth
    }

    pub(super) fn validate(&self) -> Result<(), Error> {
        for (name, value) in
            [("noise.constant", self.constant), ("noise.quadratic", self.quadratic)]
        {
            if !(0.0..=1.0).contains(&value) {
                return Err(Error::value(name, value, "a value in [0, 1]"));
            }
        }
        Ok(())
    }
}
