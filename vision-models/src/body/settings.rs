//! The parameters of the tracker.

use super::filter::Noise;
use crate::Error;

/// The parameters of a [`BodyTracker`](crate::BodyTracker). The defaults are for a depth camera at
/// 20 frames/s, 2 to 4 m from the person.
///
/// ```
/// use vision_models::TrackerSettings;
///
/// let settings = TrackerSettings { coast_limit: 0.3, ..TrackerSettings::default() };
/// assert!(settings.validate().is_ok());
/// let wrong = TrackerSettings { gate: f64::NAN, ..settings };
/// assert!(wrong.validate().unwrap_err().to_string().contains("gate"));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct TrackerSettings {
    /// Keypoints with less confidence are as good as missing. Default 0.3.
    pub least_confidence: f64,
    /// Standard deviation of the pelvis' measured floor position, each axis (m). Default 0.03.
    pub position_sigma: f64,
    /// Spectral density of the person's acceleration (m²/s³): more follows sooner, less smooths
    /// more. Default 0.1, which with the other defaults is a bandwidth of 7 rad/s.
    pub acceleration_density: f64,
    /// Nobody is faster (m/s). Default 3.
    pub max_speed: f64,
    /// Standard deviation of the measured heading (rad). Default 0.08.
    pub heading_sigma: f64,
    /// Spectral density of the heading's acceleration (rad²/s³). Default 0.5.
    pub turning_density: f64,
    /// Nobody turns faster (rad/s). Default 4.
    pub max_turning_rate: f64,
    /// A measurement more standard deviations than this away from what is expected is an outlier.
    /// Default 5.
    pub gate: f64,
    /// How many frames in a row have to agree before a person is taken up, at the start, after a
    /// loss, or in place of a track from which they are outliers. Default 4.
    pub acquire_frames: u32,
    /// Frames agree when the person's position changed by less than this between them (m), and on
    /// top by no more than the maximum speed allows. Default 0.3.
    pub acquire_radius: f64,
    /// Up to this age of the last measurement the person counts as tracked (s). Default 0.12: two
    /// frames and a little.
    pub tracked_age: f64,
    /// Up to this age the person is coasted along at constant velocity, past it lost (s). Default
    /// and maximum 0.5.
    pub coast_limit: f64,
    /// How long a heading that is no longer measured goes on turning before it is held (s).
    /// Default 0.1.
    pub turn_limit: f64,
}

impl Default for TrackerSettings {
    fn default() -> Self {
        Self {
            least_confidence: 0.3,
            position_sigma: 0.03,
            acceleration_density: 0.1,
            max_speed: 3.0,
            heading_sigma: 0.08,
            turning_density: 0.5,
            max_turning_rate: 4.0,
            gate: 5.0,
            acquire_frames: 4,
            acquire_radius: 0.3,
            tracked_age: 0.12,
            coast_limit: 0.5,
            turn_limit: 0.1,
        }
    }
}

impl TrackerSettings {
    /// Checks every field.
    ///
    /// # Errors
    /// [`Error::Setting`] names the first field that is NaN, infinite or outside its range.
    pub fn validate(&self) -> Result<(), Error> {
        let in_range = |name, value: f64, low: f64, high: f64, expected| {
            if value >= low && value <= high {
                Ok(())
            } else {
                Err(Error::Setting { name, value, expected })
            }
        };
        let scale = |name, value| in_range(name, value, 1e-6, 1e6, "a value in [1e-6, 1e6]");
        in_range("least_confidence", self.least_confidence, 0.0, 1.0, "a value in [0, 1]")?;
        scale("position_sigma", self.position_sigma)?;
        scale("acceleration_density", self.acceleration_density)?;
        scale("max_speed", self.max_speed)?;
        scale("heading_sigma", self.heading_sigma)?;
        scale("turning_density", self.turning_density)?;
        scale("max_turning_rate", self.max_turning_rate)?;
        scale("gate", self.gate)?;
        in_range("acquire_frames", self.acquire_frames.into(), 1.0, 1e3, "1 to 1000 frames")?;
        scale("acquire_radius", self.acquire_radius)?;
        in_range("coast_limit", self.coast_limit, 0.0, 0.5, "a time in [0, 0.5] s")?;
        in_range(
            "tracked_age",
            self.tracked_age,
            0.0,
            self.coast_limit,
            "a time from 0 s to coast_limit",
        )?;
        in_range("turn_limit", self.turn_limit, 0.0, 0.5, "a time in [0, 0.5] s")
    }

    pub(super) fn position_noise(&self) -> Noise {
        Noise {
            density: self.acceleration_density,
            sigma: self.position_sigma,
            max_speed: self.max_speed,
        }
    }

    pub(super) fn heading_noise(&self) -> Noise {
        Noise {
            density: self.turning_density,
            sigma: self.heading_sigma,
            max_speed: self.max_turning_rate,
        }
    }
}
