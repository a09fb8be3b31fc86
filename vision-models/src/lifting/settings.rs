//! The parameters of the lifting.

use super::skin::SkinDepths;
use crate::error::Error;

/// The parameters of a [`Lifter`](crate::Lifter). The defaults are for a RealSense D435i, 1 to 5 m
/// from the person, and a pose network with an error of 3 pixels.
///
/// ```
/// use vision_models::LiftingSettings;
///
/// let settings = LiftingSettings { pixel_sigma: 2.0, ..LiftingSettings::default() };
/// assert!(settings.validate().is_ok());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LiftingSettings {
    /// Smallest confidence of a keypoint that is used. A pose network guesses hidden joints, and
    /// the depth there belongs to the object that hides them. Default 0.4.
    pub least_confidence: f64,
    /// Standard deviation of a keypoint on each axis (pixels). Default 3.
    pub pixel_sigma: f64,
    /// Half the side of the square around the joint in which depths are read (m). In the image the
    /// square is 5 to 17 pixels wide. Default 0.03.
    pub window: f64,
    /// Smallest share of the window's pixels that must have a depth. Also the smallest share of
    /// these that make a surface. Default 0.3.
    pub least_share: f64,
    /// Smallest difference of depths by which surfaces are told apart (m). It must also exceed four
    /// standard deviations of the noise. Default 0.08.
    pub edge: f64,
    /// Range of the depths at which a person may be (m). Default 0.3 to 8.
    pub range: [f64; 2],
    /// Largest distance of a joint before or behind the middle of the trunk, along the floor (m).
    /// Default 0.9.
    pub reach: f64,
    /// Largest distance of a joint of the trunk before or behind its middle, along the floor (m).
    /// Default 0.5, for a person who bends down.
    pub trunk_reach: f64,
    /// Depths of the joints below the skin.
    pub skin: SkinDepths,
    /// Standard deviation of the depth below the skin (m). Default 0.015.
    pub skin_sigma: f64,
}

impl Default for LiftingSettings {
    fn default() -> Self {
        Self {
            least_confidence: 0.4,
            pixel_sigma: 3.0,
            window: 0.03,
            least_share: 0.3,
            edge: 0.08,
            range: [0.3, 8.0],
            reach: 0.9,
            trunk_reach: 0.5,
            skin: SkinDepths::default(),
            skin_sigma: 0.015,
        }
    }
}

impl LiftingSettings {
    /// Checks every field.
    ///
    /// # Errors
    /// [`Error::Value`] names the first field that is NaN or outside its range.
    pub fn validate(&self) -> Result<(), Error> {
        let within = |name, value: f64, low: f64, high: f64, expected| {
            if value >= low && value <= high {
                Ok(())
            } else {
                Err(Error::value(name, value, expected))
            }
        };
        let [nearest, farthest] = self.range;
        within("least_confidence", self.least_confidence, 0.0, 1.0, "a value in [0, 1]")?;
        within("pixel_sigma", self.pixel_sigma, 1e-3, 1e3, "1e-3 to 1e3 pixels")?;
        within("window", self.window, 1e-3, 0.5, "a length in [0.001, 0.5] m")?;
        within("least_share", self.least_share, 0.0, 1.0, "a share in [0, 1]")?;
        within("edge", self.edge, 1e-3, 1.0, "a length in [0.001, 1] m")?;
        within("range", nearest, 0.01, 100.0, "distances in [0.01, 100] m")?;
        within("range", farthest, nearest, 100.0, "the nearest before the farthest, to 100 m")?;
        within("reach", self.reach, 0.1, 10.0, "a length in [0.1, 10] m")?;
        within("trunk_reach", self.trunk_reach, 0.05, 10.0, "a length in [0.05, 10] m")?;
        within("skin_sigma", self.skin_sigma, 0.0, 0.3, "a length in [0, 0.3] m")?;
        self.skin.validate()
    }
}
