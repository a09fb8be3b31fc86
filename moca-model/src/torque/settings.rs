//! Settings of the torque loop.

use whole_body::torque::{Compensation, ImpedanceSettings, ObservedFriction, TorqueSettings};

use crate::error::{Error, check_settings};
use crate::robot::moca::{MOCA_BASE_JOINTS, MOCA_JOINTS};
use crate::torque::LONGEST_DELAY;

/// The delay of the robot's response.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum AnswerDelay {
    /// The delay is measured before the first motion: the last joint is pushed to and fro for some milliseconds
    /// ([`DelayProbe`](whole_body::torque::DelayProbe)).
    #[default]
    Measured,
    /// Time from a torque to its effect in a measurement, beyond the one period of every loop \[s\].
    Known(f64),
}

/// Settings of the torque law and of the observer of external torques. They have no default, because the compensation
/// of the robot itself must be stated.
///
/// ```
/// use moca_model::whole_body::torque::Compensation;
/// use moca_model::{ImpedanceSettings, TorqueLoopSettings};
///
/// let soft = TorqueLoopSettings {
///     impedance: ImpedanceSettings::soft(),
///     ..TorqueLoopSettings::new(Compensation::FRANKA)
/// };
/// assert!(soft.validate().is_ok());
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct TorqueLoopSettings {
    /// The joints with torque drives, in the order of q. The others take velocities. Default MOCA's arm.
    pub joints: Vec<String>,
    /// The side that compensates gravity, Coriolis forces and friction.
    pub compensation: Compensation,
    /// Gains of these joints, and the torque rate. The default is a Panda's.
    pub impedance: ImpedanceSettings,
    /// Inertia of the rotors at these joints \[kg m²\], which is not part of the robot's mass matrix. Default 0.1, as
    /// in MuJoCo Menagerie's Panda.
    pub rotor_inertia: f64,
    /// Delay of the robot's response. Only a [`LoopController`](crate::LoopController) measures it. Default measured.
    pub delay: AnswerDelay,
    /// Treatment of joint friction in the observer. Default: subtracts the friction of the robot's description, which
    /// is that of Gaz et al. for MOCA.
    pub friction: ObservedFriction,
}

impl TorqueLoopSettings {
    /// Creates the settings of MOCA's arm, on an interface with this compensation.
    pub fn new(compensation: Compensation) -> Self {
        let joints: Vec<_> =
            MOCA_JOINTS.iter().skip(MOCA_BASE_JOINTS).map(|name| (*name).to_owned()).collect();
        Self {
            compensation,
            impedance: ImpedanceSettings::default(),
            rotor_inertia: 0.1,
            delay: AnswerDelay::Measured,
            friction: ObservedFriction::Modelled,
            joints,
        }
    }

    /// The settings of the torque law alone.
    pub(crate) fn law(&self) -> TorqueSettings {
        TorqueSettings {
            joints: self.joints.clone(),
            compensation: self.compensation,
            rotor_inertia: self.rotor_inertia,
            impedance: self.impedance.clone(),
        }
    }

    /// Checks the ranges that do not depend on a robot.
    ///
    /// # Errors
    /// [`Error::Robot`] for a gain or the torque rate; [`Error::Value`] for an empty list of joints.
    pub fn validate(&self) -> Result<(), Error> {
        if self.joints.is_empty() {
            let what = "the number of joints driven by torque".to_owned();
            return Err(Error::Value { what, got: 0.0, wanted: "at least one" });
        }
        let inertia = [("torque.rotor_inertia", self.rotor_inertia)];
        check_settings(inertia, "from 0 to 1000 kg m²", |value| (0.0..=1e3).contains(&value))?;
        if let AnswerDelay::Known(delay) = self.delay {
            let expected = "from 0 to 0.0045 s: a later robot swings";
            let fits = |delay| (0.0..=LONGEST_DELAY).contains(&delay);
            check_settings([("torque.delay", delay)], expected, fits)?;
        }
        Ok(self.impedance.validate(self.joints.len())?)
    }
}
