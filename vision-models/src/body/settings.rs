//! The parameters of the tracker.

use super::filter::{LASTING, Measurement, Motion};
use super::joints::TRUNK;
use super::keypoints::Body25;
use crate::error::Error;

/// How fast who stands drifts: the spectral density of the velocity (m²/s), and of turning (rad²/s).
const DRIFT: f64 = 3e-6;
const TURNING_DRIFT: f64 = 1e-5;

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
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct TrackerSettings {
    /// Keypoints with less confidence are as good as missing. Default 0.3.
    pub least_confidence: f64,
    /// Standard deviation of a joint's measured position, each axis, where no covariances are known (m).
    /// Default 0.03.
    pub position_sigma: f64,
    /// Spectral density of the acceleration of who walks (m²/s³): more follows sooner, less smooths more. Default 0.6,
    /// of gait up to 1.4 m/s.
    pub walking_density: f64,
    /// The same of the joints of the trunk and the head (m²/s³). Default 1.
    pub trunk_density: f64,
    /// The same of wrists (m²/s³); elbows have 0.4 of it, knees 0.8, ankles and feet 1.5. Default 8.
    pub limb_density: f64,
    /// Nobody is faster (m/s). Default 3.
    pub max_speed: f64,
    /// Standard deviation of the measured heading, where covariances are not known (rad). Default
    /// 0.08.
    pub heading_sigma: f64,
    /// Spectral density of the heading's acceleration (rad²/s³). Default 0.5.
    pub turning_density: f64,
    /// Nobody turns faster (rad/s). Default 4.
    pub max_turning_rate: f64,
    /// A measurement more standard deviations than this away from what is expected is an outlier.
    /// Default 5.
    pub gate: f64,
    /// The probability that noise alone is as far from what is expected as a measurement has to be,
    /// in each of the frames in which a person seems to be elsewhere, to count as a jump. Default
    /// 1e-9.
    pub jump_probability: f64,
    /// How long errors of joints whose covariances are known last: their correlation fades as
    /// exp(-interval/time) (s). Default 0.16, as of real detectors.
    pub correlation_time: f64,
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
            walking_density: 0.6,
            trunk_density: 1.0,
            limb_density: 8.0,
            max_speed: 3.0,
            heading_sigma: 0.08,
            turning_density: 0.5,
            max_turning_rate: 4.0,
            gate: 5.0,
            jump_probability: 1e-9,
            correlation_time: 0.16,
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
    /// [`Error::Value`] names the first field that is NaN, infinite or outside its range.
    pub fn validate(&self) -> Result<(), Error> {
        let in_range = |name, value: f64, low: f64, high: f64, expected| {
            if value >= low && value <= high {
                Ok(())
            } else {
                Err(Error::value(name, value, expected))
            }
        };
        let scale = |name, value| in_range(name, value, 1e-6, 1e6, "a value in [1e-6, 1e6]");
        in_range("least_confidence", self.least_confidence, 0.0, 1.0, "a value in [0, 1]")?;
        scale("position_sigma", self.position_sigma)?;
        scale("walking_density", self.walking_density)?;
        scale("trunk_density", self.trunk_density)?;
        scale("limb_density", self.limb_density)?;
        scale("max_speed", self.max_speed)?;
        scale("heading_sigma", self.heading_sigma)?;
        scale("turning_density", self.turning_density)?;
        scale("max_turning_rate", self.max_turning_rate)?;
        scale("gate", self.gate)?;
        let probability = self.jump_probability;
        in_range("jump_probability", probability, 1e-300, 1.0, "a probability in [1e-300, 1]")?;
        in_range("correlation_time", self.correlation_time, 0.0, 10.0, "a time in [0, 10] s")?;
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

    /// How the person stands and walks.
    pub(super) fn walking(&self) -> Motion {
        self.motion(self.walking_density, DRIFT, self.max_speed, self.coast_limit)
    }

    /// How a joint moves.
    pub(super) fn joint(&self, joint: Body25) -> Motion {
        use Body25::{LeftElbow, LeftKnee, LeftWrist, RightElbow, RightKnee, RightWrist};
        let of_limb = |share| (share * self.limb_density, 2.0 * self.max_speed);
        let (density, max_speed) = match joint {
            _ if TRUNK.contains(&joint) => (self.trunk_density, self.max_speed),
            LeftElbow | RightElbow => of_limb(0.4),
            LeftWrist | RightWrist => of_limb(1.0),
            LeftKnee | RightKnee => of_limb(0.8),
            _ => of_limb(1.5),
        };
        self.motion(density, 0.0, max_speed, self.coast_limit)
    }

    pub(super) fn turning(&self) -> Motion {
        self.motion(self.turning_density, TURNING_DRIFT, self.max_turning_rate, self.turn_limit)
    }

    fn motion(&self, density: f64, drift: f64, max_speed: f64, coasts: f64) -> Motion {
        Motion { density, drift, max_speed, coasts, correlation_time: self.correlation_time }
    }

    /// A heading, with the standard deviation of one frame where no variance is known.
    pub(super) fn heading(&self, angle: f64, variance: Option<f64>) -> Measurement<1> {
        let lasting = if variance.is_some() { LASTING } else { 0.0 };
        let variance = variance.unwrap_or(self.heading_sigma.powi(2));
        Measurement { position: [angle].into(), covariance: [[variance]].into(), lasting }
    }

    /// The square of the distance beyond which a measurement is an outlier.
    pub(super) fn outlier_distance(&self) -> f64 {
        self.gate.powi(2)
    }

    /// The square of the distance beyond which measurements may be a jump. Of two axes, distances
    /// beyond d have the probability exp(-d²/2); of one, less.
    pub(super) fn jump_distance(&self) -> f64 {
        self.outlier_distance().max(-2.0 * self.jump_probability.ln())
    }

    /// Of a covariance, by errors that last over several frames: the variance of the mean of many
    /// frames whose errors have the correlation ρ from one to the next, over that of independent
    /// ones.
    pub(super) fn inflation(&self, interval: f64) -> f64 {
        let correlation = (-interval.max(1e-3) / self.correlation_time.max(1e-9)).exp();
        (1.0 + correlation) / (1.0 - correlation)
    }
}
