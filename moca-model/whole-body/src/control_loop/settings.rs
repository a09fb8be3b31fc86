//! Times of a control loop.

use crate::error::Error;

/// The times of a control loop: its period and its timeouts.
///
/// ```
/// use whole_body::control_loop::LoopSettings;
///
/// assert!(LoopSettings::default().validate().is_ok());
/// assert!(LoopSettings { period: 0.0, ..LoopSettings::default() }.validate().is_err());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopSettings {
    /// The control period \[s\]. Default 0.001.
    pub period: f64,
    /// Longest wait for the first measurement \[s\]. Default 5.
    pub first_measurement: f64,
    /// Time for which the loop then measures the interval of measurements \[s\]; see
    /// [`ControlLaw::longest_interval`](crate::control_loop::ControlLaw::longest_interval). Default 0.05.
    pub listening: f64,
    /// The loop stops and ends after this time without a measurement \[s\]. Default 0.02.
    pub robot_timeout: f64,
    /// The loop stops and ends after this time without perception \[s\]. Before that the law slows the robot down.
    /// Infinity waits for ever. Default 30.
    pub perception_timeout: f64,
    /// Time after the beginning of a stop at which a robot that is not at rest is halted \[s\]. Default 3.
    pub stop_within: f64,
    /// A robot without measurements for this long is halted \[s\], since only its own brakes know how it moves. Default
    /// 0.1.
    pub blind_within: f64,
}

impl Default for LoopSettings {
    fn default() -> Self {
        Self {
            period: 1e-3,
            first_measurement: 5.0,
            listening: 0.05,
            robot_timeout: 0.02,
            perception_timeout: 30.0,
            stop_within: 3.0,
            blind_within: 0.1,
        }
    }
}

impl LoopSettings {
    /// Checks the ranges.
    ///
    /// # Errors
    /// [`Error::Value`] names the first that is out of its range.
    pub fn validate(&self) -> Result<(), Error> {
        for (what, value) in [
            ("the loop's period", self.period),
            ("the wait for the first measurement", self.first_measurement),
            ("the time of listening", self.listening),
            ("the robot's timeout", self.robot_timeout),
            ("the time to stop within", self.stop_within),
            ("the time without a measurement", self.blind_within),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(Error::value(what, value, "positive and finite"));
            }
        }
        let value = self.perception_timeout;
        if value.is_nan() || value <= 0.0 {
            let what = "the perception's timeout";
            return Err(Error::value(what, value, "positive"));
        }
        let (what, value) = ("the robot's timeout", self.robot_timeout);
        if value <= self.period {
            return Err(Error::value(what, value, "above the loop's period"));
        }
        Ok(())
    }
}
