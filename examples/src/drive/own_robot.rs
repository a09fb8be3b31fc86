//! The robot that a loop moves, as a settings file describes it.

use std::path::Path;

use anyhow::{Context, Result, ensure};
use moca_drivers::SimulatedSide;
#[cfg(feature = "ros2")]
use moca_drivers::ros2::RobotJoints;
use moca_model::whole_body::Model;
use moca_model::{ControllerSettings, MOCA_HOME, TorqueLoopSettings, moca};
use moca_simulation::plant::RobotNoise;
use moca_simulation::run::Scenario;

use crate::settings::{RobotSettings, SettingsFile};

/// Seed of a simulated robot's noise.
const SEED: u64 = 1;

/// A robot, where it begins, and its settings.
#[derive(Debug)]
pub struct DrivenRobot {
    /// The robot.
    pub model: Model,
    /// Configuration at the beginning \[m, rad\].
    pub start: Vec<f64>,
    /// Settings of its controller, of its torque law, and of topics.
    pub settings: RobotSettings,
}

impl From<&Scenario> for DrivenRobot {
    fn from(scenario: &Scenario) -> Self {
        let Scenario { model, start, settings, torques, .. } = scenario;
        let settings = RobotSettings {
            controller: settings.clone(),
            torque: torques.clone(),
            ..RobotSettings::default()
        };
        Self { model: model.clone(), start: start.clone(), settings }
    }
}

impl DrivenRobot {
    /// The scenario with this robot.
    pub fn in_scenario(self, scenario: Scenario) -> Scenario {
        let RobotSettings { controller, torque, .. } = self.settings;
        Scenario {
            model: self.model,
            start: self.start,
            settings: controller,
            torques: torque,
            ..scenario
        }
    }

    /// The robot of a settings file, if there is one, else MOCA. Settings that the file leaves out are those of `base`,
    /// or those of another robot with the shared workspace of `base`.
    ///
    /// # Errors
    /// The file, with what is wrong in it.
    pub fn read(base: RobotSettings, file: Option<(&Path, &SettingsFile)>) -> Result<Self> {
        let Some((path, file)) = file else {
            return Ok(Self { model: moca()?, start: MOCA_HOME.to_vec(), settings: base });
        };
        Self::of_file(base, path, file).with_context(|| path.display().to_string())
    }

    fn of_file(base: RobotSettings, path: &Path, file: &SettingsFile) -> Result<Self> {
        let settings = file.unchecked_over(&base)?;
        let folder = path.parent().unwrap_or(Path::new("."));
        let tool = &settings.controller.tool;
        let Some(model) = settings.robot.read(folder, tool)? else {
            let settings = file.over(&base)?;
            return Ok(Self { model: moca()?, start: MOCA_HOME.to_vec(), settings });
        };
        let posture = file.has("controller.posture.configuration");
        let start = if posture {
            settings.controller.posture.configuration.clone()
        } else {
            model.neutral()
        };
        let base = RobotSettings {
            controller: ControllerSettings {
                space: base.controller.space,
                ..ControllerSettings::of_robot(&model, tool, &start)
            },
            torque: TorqueLoopSettings::of_robot(&model, base.torque.compensation),
            ..base
        };
        let joints = base.torque.joints.len();
        for gains in ["stiffness", "damping"] {
            let setting = format!("torque.impedance.{gains}");
            ensure!(
                file.has(&setting) || joints == base.torque.impedance.stiffness.len(),
                "{setting} is missing: its default is a Panda's, and this robot has {joints} joints driven by torque; \
                 give one number for each"
            );
        }
        Ok(Self { settings: file.over(&base)?, model, start })
    }

    /// The number of its first joints, which take velocities.
    ///
    /// # Errors
    /// Torque drives that are not the last joints.
    pub fn base_joints(&self) -> Result<usize> {
        let driven = &self.settings.torque.joints;
        let base = self.model.joints().len().saturating_sub(driven.len());
        let last = self.model.joints().iter().skip(base).map(|joint| &joint.name);
        ensure!(
            last.eq(driven),
            "torque.joints are {}: the joints with torque drives come last in q, in its order",
            driven.join(", ")
        );
        Ok(base)
    }

    /// The robot, simulated at its start.
    ///
    /// # Errors
    /// Those of [`base_joints`](Self::base_joints) and of [`SimulatedSide::of_robot`].
    pub fn simulated(&self) -> Result<SimulatedSide> {
        let ControllerSettings { tool, period, .. } = &self.settings.controller;
        let (model, base, noise) = (self.model.clone(), self.base_joints()?, RobotNoise::new(SEED));
        Ok(SimulatedSide::of_robot(model, tool, base, &self.start, *period, noise)?)
    }

    /// Joints of the robot on the ROS 2 graph.
    ///
    /// # Errors
    /// Those of [`base_joints`](Self::base_joints), and a base that is not one of x, y and yaw.
    #[cfg(feature = "ros2")]
    pub fn ros2_joints(&self) -> Result<RobotJoints> {
        let arm = self.settings.torque.joints.clone();
        match self.base_joints()? {
            0 => Ok(RobotJoints::of_arm(arm)),
            3 => Ok(RobotJoints::on_base(arm)),
            other => anyhow::bail!(
                "the first {other} joints take velocities: on ROS 2 they are x, y and yaw of a base, or there are none"
            ),
        }
    }
}
