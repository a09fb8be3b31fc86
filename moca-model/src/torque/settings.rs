//! Gains and rates of the torque loop.

use whole_body::{ImpedanceSettings, ObservedFriction};

use crate::error::Error;
use crate::robot::moca::{MOCA_BASE_JOINTS, MOCA_JOINTS};

/// What turns a controller's commands into torques, and torques into who pushes.
///
/// ```
/// use moca_model::{ImpedanceSettings, TorqueLoopSettings};
///
/// let soft = TorqueLoopSettings {
///     impedance: ImpedanceSettings::soft(),
///     ..TorqueLoopSettings::default()
/// };
/// assert!(soft.validate().is_ok());
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct TorqueLoopSettings {
    /// The joints that are driven by torque, in the order of q. The others take velocities. Default
    /// MOCA's arm.
    pub joints: Vec<String>,
    /// Gains of these, and the torque rate. Default a Panda's.
    pub impedance: ImpedanceSettings,
    /// Rates of the observer of torques from outside, one each of these joints \[1/s\]. Default 50.
    pub observer_rates: Vec<f64>,
    /// Whether friction in the joints is taken off what is observed. Default that of the robot's
    /// description, which is that of Gaz et al. for MOCA.
    pub friction: ObservedFriction,
}

impl Default for TorqueLoopSettings {
    fn default() -> Self {
        let joints: Vec<_> =
            MOCA_JOINTS.iter().skip(MOCA_BASE_JOINTS).map(|name| (*name).to_owned()).collect();
        Self {
            impedance: ImpedanceSettings::default(),
            observer_rates: vec![50.0; joints.len()],
            friction: ObservedFriction::Modelled,
            joints,
        }
    }
}

impl TorqueLoopSettings {
    /// Checks the ranges that need no robot to be checked.
    ///
    /// # Errors
    /// [`Error::Robot`] for a gain or the torque rate; [`Error::Setting`] without any joint.
    pub fn validate(&self) -> Result<(), Error> {
        if self.joints.is_empty() {
            let (name, expected) = ("the number of joints driven by torque", "at least one");
            return Err(Error::Setting { name, value: 0.0, expected });
        }
        Ok(self.impedance.validate(self.joints.len())?)
    }
}
