//! Limits of a base on mecanum wheels.

use crate::error::{Error, check_positive, check_settings};
use crate::robot::moca::{MOCA_AXIS_SPEED, MOCA_WHEEL_LEVER, MOCA_WHEEL_SPEED};

/// The limits of a mecanum base. Its wheels limit |v_x| + |v_y| + lever |ω| in its own frame, and its controller limits
/// |v_x| and |v_y|.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct MecanumBase {
    /// Largest value of the sum \[m/s\].
    pub speed: f64,
    /// Lever of the yaw rate \[m\].
    pub lever: f64,
    /// Largest speed along each of the base's own axes \[m/s\].
    pub axis_speed: f64,
}

impl Default for MecanumBase {
    /// The limits of the SUMMIT-XL STEEL.
    fn default() -> Self {
        Self { speed: MOCA_WHEEL_SPEED, lever: MOCA_WHEEL_LEVER, axis_speed: MOCA_AXIS_SPEED }
    }
}

impl MecanumBase {
    /// Checks the ranges.
    ///
    /// # Errors
    /// [`Error::Value`] names the first that is out of its range.
    pub fn validate(&self) -> Result<(), Error> {
        check_positive([("base.speed", self.speed), ("base.axis_speed", self.axis_speed)])?;
        let lever = [("base.lever", self.lever)];
        check_settings(lever, "from 0 to 1000 m", |value| (0.0..=1e3).contains(&value))
    }
}
