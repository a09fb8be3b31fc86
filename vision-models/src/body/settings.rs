//! The parameters of the tracker.

use super::filter::{LASTING, Measurement, Motion};
use super::joints::TRUNK;
use super::keypoints::Body25;
use crate::error::Error;

/// Drift of a standing person: spectral densities of the velocity (m²/s) and of the turning rate
/// (rad²/s).
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
    /// Keypoints with less confidence count as missing. Default 0.3.
    pub least_confidence: f64,
    /// Standard deviation of a joint's measured position on each axis, if covariances are unknown
    /// (m). Default 0.03.
    pub position_sigma: f64,
    /// Spectral density of a walking person's acceleration (m²/s³). Larger values follow sooner,
    /// smaller ones smooth more. Default 0.6, for gait up to 1.4 m/s.
    pub walking_density: f64,
    /// Spectral density of the acceleration of the joints of trunk and head (m²/s³). Default 1.
    pub trunk_density: f64,
    /// Spectral density of the acceleration of wrists (m²/s³). Elbows have 0.4 of it, knees 0.8,
    /// ankles and feet 1.5. Default 8.
    pub limb_density: f64,
    /// Largest speed of a person (m/s). Default 3.
    pub max_speed: f64,
    /// Standard deviation of the measured heading, if covariances are unknown (rad). Default 0.08.
    pub heading_sigma: f64,
    /// Spectral density of the heading's acceleration (rad²/s³). Default 0.5.
    pub turning_density: f64,
    /// Largest turning rate of a person (rad/s). Default 4.
    pub max_turning_rate: f64,
    /// A measurement farther than this from the expected value is an outlier (standard deviations).
    /// Default 5.
    pub gate: f64,
    /// Largest probability with which noise alone explains a jump's distance in each of its frames.
    /// Default 1e-9.
    pub jump_probability: f64,
    /// Correlation time of the errors of joints with known covariances (s). The correlation fades
    /// as exp(-interval/time). Default 0.16, measured on real detectors.
    pub correlation_time: f64,
    /// Number of consecutive frames that must agree before a person is tracked: at the start, after
    /// a loss, or after outliers that replace a track. Default 4.
    pub acquire_frames: u32,
    /// Frames agree if the person's position changes between them by less than this (m) plus the
    /// distance at maximum speed. Default 0.3.
    pub acquire_radius: f64,
    /// Largest age of the last measurement at which the person counts as tracked (s). Default 0.12,
    /// a little more than two frames.
    pub tracked_age: f64,
    /// Largest age up to which the pose is predicted at constant velocity (s). Beyond it the person
    /// is lost. Default and maximum 0.5.
    pub coast_limit: f64,
    /// How long a heading that is not measured continues to turn before it is held (s). Default
    /// 0.1.
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

    /// Returns the motion of a person who stands or walks.
    pub(super) fn walking(&self) -> Motion {
        self.motion(self.walking_density, DRIFT, self.max_speed, self.coast_limit)
    }

    /// Returns the motion of a joint.
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

    /// Returns a measured heading. An unknown variance is replaced by the standard deviation of one
    /// frame.
    pub(super) fn heading(&self, angle: f64, variance: Option<f64>) -> Measurement<1> {
        let lasting = if variance.is_some() { LASTING } else { 0.0 };
        let variance = variance.unwrap_or(self.heading_sigma.powi(2));
        Measurement { position: [angle].into(), covariance: [[variance]].into(), lasting }
    }

    /// Returns the squared distance beyond which a measurement is an outlier.
    pub(super) fn outlier_distance(&self) -> f64 {
        self.gate.powi(2)
    }

    /// Returns the squared distance beyond which measurements may be a jump. Distances beyond d
    /// have the probability exp(-d²/2) on two axes, and less on one.
    pub(super) fn jump_distance(&self) -> f64 {
        self.outlier_distance().max(-2.0 * self.jump_probability.ln())
    }

    /// Returns the factor of a covariance due to errors that last over several frames. It is the
    /// variance of the mean of many frames whose successive errors have the correlation ρ, divided
    /// by that of independent frames.
    pub(super) fn inflation(&self, interval: f64) -> f64 {
        let correlation = (-interval.max(1e-3) / self.correlation_time.max(1e-9)).exp();
        (1.0 + correlation) / (1.0 - correlation)
    }
}
