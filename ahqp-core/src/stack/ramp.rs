//! Smooth transitions of a number.

use crate::error::Error;

/// Largest slope of the minimum-jerk polynomial, at its middle.
const PEAK_SLOPE: f64 = 15.0 / 8.0;

/// A transition along the minimum-jerk polynomial 10s³ − 15s⁴ + 6s⁵, with zero velocity and
/// acceleration at both ends (Flash and Hogan, J. Neurosci. 5(7), 1985).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ramp {
    from: f64,
    to: f64,
    duration: f64,
    elapsed: f64,
}

impl Ramp {
    /// # Errors
    /// [`Error::Value`] if the duration is negative or not finite.
    pub(super) fn new(from: f64, to: f64, duration: f64) -> Result<Self, Error> {
        if duration >= 0.0 && duration.is_finite() {
            Ok(Self { from, to, duration, elapsed: 0.0 })
        } else {
            let expected = "finite and not negative [s]";
            Err(Error::value("the duration of a change", duration, expected))
        }
    }

    pub(super) fn advance(&mut self, period: f64) {
        self.elapsed = (self.elapsed + period).min(self.duration);
    }

    pub(super) fn is_over(&self) -> bool {
        self.elapsed >= self.duration
    }

    pub(super) fn target(&self) -> f64 {
        self.to
    }

    pub(super) fn value(&self) -> f64 {
        if self.is_over() {
            return self.to;
        }
        let s = self.elapsed / self.duration;
        let share = s * s * s * (10.0 - s * (15.0 - 6.0 * s));
        self.from + share * (self.to - self.from)
    }

    /// Returns an upper bound of the remaining rate of change \[1/s\].
    pub(super) fn rate(&self) -> f64 {
        if self.is_over() { 0.0 } else { PEAK_SLOPE * (self.to - self.from).abs() / self.duration }
    }
}
