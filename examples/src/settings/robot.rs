//! The settings that a file holds.

use moca_model::{ControllerSettings, TorqueLoopSettings};
use moca_simulation::plant::{Drive, PlantSettings};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::error::SettingsError;
use super::text;

/// The version of files of settings that is read and written.
pub const SETTINGS_VERSION: i64 = 1;

/// The settings of the controller and of the loop of torques below it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobotSettings {
    /// The controller, from percepts to velocities.
    pub controller: ControllerSettings,
    /// What turns the velocities of the arm into torques, and torques into who pushes.
    pub torque: TorqueLoopSettings,
}

/// Those of the simulated robot, whose motors compensate nothing.
impl Default for RobotSettings {
    fn default() -> Self {
        Self::from(&PlantSettings::default())
    }
}

impl From<&PlantSettings> for RobotSettings {
    fn from(plant: &PlantSettings) -> Self {
        Self { controller: plant.controller.clone(), torque: plant.torques.clone() }
    }
}

impl RobotSettings {
    /// The same for a robot that does this with commands.
    pub fn of_plant(self, drive: Drive) -> PlantSettings {
        PlantSettings { drive, controller: self.controller, torques: self.torque }
    }

    /// The text of a file with all settings, each with what it means. Where the person's hand works is
    /// written as a comment, since it follows from the person's stature unless a file says otherwise.
    ///
    /// # Errors
    /// [`SettingsError::Write`] for what TOML cannot hold, a count above 2⁶³.
    pub fn to_toml(&self) -> Result<String, SettingsError> {
        text::write(self)
    }

    /// Checks the ranges that need no robot to be checked.
    ///
    /// # Errors
    /// The first that is outside its range.
    pub fn validate(&self) -> Result<(), moca_model::Error> {
        let Self { controller, torque } = self;
        controller.validate()?;
        controller.intention.validate()?;
        controller.tracker.validate()?;
        controller.follower.validate()?;
        controller.safety.validate()?;
        torque.validate()
    }
}
