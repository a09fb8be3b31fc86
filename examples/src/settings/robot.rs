//! The settings in a file.

use moca_drivers::TopicNames;
use moca_model::{ControllerSettings, TorqueLoopSettings};
use moca_simulation::plant::{Drive, PlantSettings};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::camera_place::CameraPlace;
use super::own_robot::OwnRobot;

/// The settings of the controller, of the torque loop below it, and of the connection to a robot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobotSettings {
    /// The controller, from percepts to velocities.
    pub controller: ControllerSettings,
    /// The torque law of the arm, and the observer of external torques.
    pub torque: TorqueLoopSettings,
    /// Another robot than MOCA, for `drive`. Its settings that this file leaves out are those of a robot without
    /// capsules.
    pub robot: OwnRobot,
    /// The camera that sees the people, for `perceive`.
    pub camera: CameraPlace,
    /// Names of the topics on the ROS 2 graph.
    pub topics: TopicNames,
}

/// Creates the settings of the simulated robot, whose motors compensate nothing.
impl Default for RobotSettings {
    fn default() -> Self {
        Self::from(&PlantSettings::default())
    }
}

impl From<&PlantSettings> for RobotSettings {
    fn from(plant: &PlantSettings) -> Self {
        Self {
            controller: plant.controller.clone(),
            torque: plant.torques.clone(),
            robot: OwnRobot::default(),
            camera: CameraPlace::default(),
            topics: TopicNames::default(),
        }
    }
}

impl RobotSettings {
    /// The settings of a plant with this drive.
    pub fn of_plant(self, drive: Drive) -> PlantSettings {
        PlantSettings { drive, controller: self.controller, torques: self.torque }
    }

    /// Checks the ranges that do not depend on a robot.
    ///
    /// # Errors
    /// The first setting that is outside its range.
    pub fn validate(&self) -> Result<(), moca_model::Error> {
        let Self { controller, torque, camera, .. } = self;
        camera.isometry()?;
        controller.validate()?;
        controller.safety.validate()?;
        torque.validate()
    }
}
