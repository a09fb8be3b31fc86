//! Feedback: how fast an error is to vanish.

use nalgebra::SVector;

use crate::error::Error;

/// The speed at which an error is to vanish. Near the target it is gain · error. Far from it, it is limited so that a
/// chosen deceleration suffices to stop.
///
/// The speed v towards a target at distance e solves v/gain + v²/(2 deceleration) = e. It is gain · e for small e and
/// √(2 deceleration e) for large ones. Following it never decelerates by more than `deceleration`. A robot that has
/// fallen behind would otherwise arrive too fast for its acceleration limits and oscillate about the target.
///
/// ```
/// use whole_body::tasks::Feedback;
///
/// let feedback = Feedback { gain: 20.0, deceleration: 2.0 };
/// assert!((feedback.speed(1e-6) - 20e-6).abs() < 1e-8);
/// assert!(feedback.speed(1.0) < 2.0); // √(2 · 2 · 1) m/s
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Feedback {
    /// Gain \[1/s\], at most one over the control period.
    pub gain: f64,
    /// Deceleration \[m/s² or rad/s²\]; infinite for no limit.
    pub deceleration: f64,
}

impl Feedback {
    /// Feedback of lengths: 20 1/s, 2.5 m/s².
    pub const LINEAR: Self = Self { gain: 20.0, deceleration: 2.5 };
    /// Feedback of angles: 20 1/s, 5 rad/s².
    pub const ANGULAR: Self = Self { gain: 20.0, deceleration: 5.0 };
    /// Feedback of joints: 2 1/s, 2 rad/s² or m/s².
    pub const JOINT: Self = Self { gain: 2.0, deceleration: 2.0 };

    /// Returns the feedback with another gain \[1/s\].
    #[must_use]
    pub fn with_gain(self, gain: f64) -> Self {
        Self { gain, ..self }
    }

    /// The speed towards a target at distance `error`, with the sign of `error`.
    pub fn speed(&self, error: f64) -> f64 {
        let time = 1.0 / self.gain;
        let root = (time * time + 2.0 * error.abs() / self.deceleration).sqrt();
        2.0 * error / (time + root)
    }

    /// The velocity that reduces an error vector along a straight line.
    pub(crate) fn velocity<const D: usize>(&self, error: &SVector<f64, D>) -> SVector<f64, D> {
        let distance = error.norm();
        if distance > 0.0 { error * (self.speed(distance) / distance) } else { *error }
    }

    /// Returns an error unless both numbers are positive and the gain finite.
    pub(crate) fn validate(&self) -> Result<(), Error> {
        if !(self.gain > 0.0 && self.gain.is_finite()) {
            let expected = "positive and finite [1/s]";
            return Err(Error::value("the gain", self.gain, expected));
        }
        if self.deceleration.is_nan() || self.deceleration <= 0.0 {
            let (what, value) = ("the deceleration of the feedback", self.deceleration);
            return Err(Error::value(what, value, "positive, or infinite for none"));
        }
        Ok(())
    }

    /// Returns an error if one step would overshoot.
    pub(crate) fn check_period(&self, period: f64) -> Result<(), Error> {
        if self.gain * period <= 1.0 + 1e-9 {
            Ok(())
        } else {
            Err(Error::too_high(self.gain, period))
        }
    }
}
