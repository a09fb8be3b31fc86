//! The parameters of the tracker.

use super::body_25::Body25;
use super::filter::{Measurement, Motion};
use super::freshness::Freshness;
use super::heading::Heading;
use crate::error::Error;

/// Joints of the head and the trunk.
const TRUNK: [Body25; 11] = [
    Body25::Nose,
    Body25::Neck,
    Body25::LeftShoulder,
    Body25::RightShoulder,
    Body25::MidHip,
    Body25::LeftHip,
    Body25::RightHip,
    Body25::LeftEye,
    Body25::RightEye,
    Body25::LeftEar,
    Body25::RightEar,
];

/// Spectral density of a walking person's acceleration (m²/s³), for gait up to 1.4 m/s.
const WALKING: f64 = 0.53;
/// Spectral density of the acceleration of the joints of trunk and head (m²/s³).
const TRUNK_DENSITY: f64 = 1.0;
/// Spectral density of the acceleration of wrists (m²/s³). Elbows have 0.4 of it, knees 0.8, ankles
/// and feet 1.5.
const LIMB_DENSITY: f64 = 8.0;
/// Spectral density of the heading's acceleration (rad²/s³).
const TURNING: f64 = 0.5;
/// Largest speed (m/s) and turning rate (rad/s) of a person.
pub(super) const MAX_SPEED: f64 = 3.0;
const MAX_TURNING_RATE: f64 = 4.0;
/// Time for which an unmeasured heading continues to turn before it is held (s).
pub(super) const TURN_LIMIT: f64 = 0.1;
/// A measurement farther than this from the expected value is an outlier (standard deviations).
const GATE: f64 = 5.0;
/// Largest probability with which noise alone explains a jump's distance in each of its frames.
const JUMP_PROBABILITY: f64 = 1e-9;
/// Correlation time of the errors of joints with known covariances (s), measured on real detectors.
/// The correlation fades as exp(-interval/time).
const CORRELATION_TIME: f64 = 0.16;
/// Number of consecutive frames that must agree before a person is tracked: at the start, after a
/// loss, or after outliers that replace a track.
pub(super) const ACQUIRE_FRAMES: u32 = 4;
/// Frames agree if the person's position changes between them by less than this (m) plus the
/// distance at maximum speed.
pub(super) const ACQUIRE_RADIUS: f64 = 0.3;
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
/// let settings = TrackerSettings { least_confidence: 0.5, ..TrackerSettings::default() };
/// assert!(settings.validate().is_ok());
/// let wrong = TrackerSettings { position_sigma: f64::NAN, ..settings };
/// assert!(wrong.validate().unwrap_err().to_string().contains("position_sigma"));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct TrackerSettings {
    /// Keypoints with less confidence count as missing. Default 0.3.
    pub least_confidence: f64,
    /// Least standard deviation of a joint's measured position on each axis, if covariances are
    /// unknown (m). The frames may show a larger one. Default 0.03.
    pub position_sigma: f64,
    /// Standard deviation of the measured heading, if covariances are unknown (rad). Default 0.08.
    pub heading_sigma: f64,
}

impl Default for TrackerSettings {
    fn default() -> Self {
        Self { least_confidence: 0.3, position_sigma: 0.03, heading_sigma: 0.08 }
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
        scale("heading_sigma", self.heading_sigma)
    }

    /// Returns a measured heading. An unknown variance is replaced by the standard deviation of one
    /// frame.
    pub(super) fn heading(&self, angle: f64, heading: &Heading) -> Measurement<1> {
        let Heading { variance, lasting, .. } = *heading;
        let variance = variance.unwrap_or(self.heading_sigma.powi(2));
        Measurement { position: [angle].into(), covariance: [[variance]].into(), lasting }
    }
}

/// Returns the motion of a person who stands or walks.
pub(super) fn walking() -> Motion {
    motion(WALKING, DRIFT, MAX_SPEED, Freshness::COASTING)
}

/// Returns the motion of a joint.
pub(super) fn moving(joint: Body25) -> Motion {
    use Body25::{LeftElbow, LeftKnee, LeftWrist, RightElbow, RightKnee, RightWrist};
    let of_limb = |share| (share * LIMB_DENSITY, 2.0 * MAX_SPEED);
    let (density, max_speed) = match joint {
        _ if TRUNK.contains(&joint) => (TRUNK_DENSITY, MAX_SPEED),
        LeftElbow | RightElbow => of_limb(0.4),
        LeftWrist | RightWrist => of_limb(1.0),
        LeftKnee | RightKnee => of_limb(0.8),
        _ => of_limb(1.5),
    };
    motion(density, 0.0, max_speed, Freshness::COASTING)
}

/// Returns the motion of a heading.
pub(super) fn turning() -> Motion {
    motion(TURNING, TURNING_DRIFT, MAX_TURNING_RATE, TURN_LIMIT)
}

fn motion(density: f64, drift: f64, max_speed: f64, coasts: f64) -> Motion {
    Motion { density, drift, max_speed, coasts, correlation_time: CORRELATION_TIME }
}

/// Returns the squared distance beyond which a measurement is an outlier.
pub(super) fn outlier_distance() -> f64 {
    GATE * GATE
}

/// Returns the squared distance beyond which measurements may be a jump. Distances beyond d have the
/// probability exp(-d²/2) on two axes, and less on one.
pub(super) fn jump_distance() -> f64 {
    outlier_distance().max(-2.0 * JUMP_PROBABILITY.ln())
}

/// Returns the factor of a covariance due to errors that last over several frames. It is the
/// variance of the mean of many frames whose successive errors have the correlation ρ, divided by
/// that of independent frames.
pub(super) fn inflation(interval: f64) -> f64 {
    let correlation = correlation(interval.max(1e-3));
    (1.0 + correlation) / (1.0 - correlation)
}

/// Returns the correlation of the lasting errors of two frames that are so far apart (s).
pub(super) fn correlation(interval: f64) -> f64 {
    (-interval / CORRELATION_TIME).exp()
}
