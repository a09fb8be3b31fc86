//! Simulated robot in the process of the loop.

use std::fmt;

use moca_model::whole_body::control_loop::{
    Grip, JointCommand, JointMeasurement, Received, RobotSide, RobotStatus,
};
use moca_model::whole_body::simulation::RandomSource;
use moca_model::whole_body::state::PayloadId;
use moca_model::whole_body::{FrameId, Model};
use moca_model::{
    ControllerSettings, DynamicRobot, DynamicRobotSettings, Error, GraspedObject, MOCA_BASE_JOINTS,
    moca,
};

#[cfg(feature = "ros2")]
use nalgebra::Isometry3;

use super::command_limits::{CommandLimits, CommandRefusal};

/// Largest joint speed of a robot that counts as at rest \[m/s or rad/s\].
const REST: f64 = 0.01;

/// MOCA or another robot as rigid bodies. It moves for one period with every command.
///
/// A command beyond its limits is refused and counts as lost. A robot that has stopped by itself accepts commands again
/// once it stands still, if the first of them begins at rest. Its gripper holds [`GraspedObject::default`] as soon as it is
/// told to close, and nothing once it is told to open.
#[derive(Debug)]
pub struct SimulatedSide {
    robot: DynamicRobot,
    model: Model,
    tool: FrameId,
    held: Option<PayloadId>,
    limits: CommandLimits,
    noise: Noise,
    period: f64,
    refused: u64,
}

/// Source of noise that the caller chooses.
struct Noise(Box<dyn RandomSource + Send>);

impl fmt::Debug for Noise {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Noise")
    }
}

impl RandomSource for Noise {
    fn normal(&mut self) -> f64 {
        self.0.normal()
    }

    fn uniform(&mut self) -> f64 {
        self.0.uniform()
    }
}

impl SimulatedSide {
    /// Creates a robot at rest at `start` \[m, rad\], with a control `period` \[s\] and this noise.
    ///
    /// # Errors
    /// A start that is no valid configuration.
    pub fn new(
        start: &[f64],
        period: f64,
        noise: impl RandomSource + Send + 'static,
    ) -> Result<Self, Error> {
        let tool = ControllerSettings::default().tool;
        Self::of_robot(moca()?, &tool, MOCA_BASE_JOINTS, start, period, noise)
    }

    /// Creates another robot with this tool. Its first `base_joints` joints follow velocities, the others torques.
    ///
    /// # Errors
    /// A tool that the robot does not have, and those of [`new`](Self::new).
    pub fn of_robot(
        model: Model,
        tool: &str,
        base_joints: usize,
        start: &[f64],
        period: f64,
        noise: impl RandomSource + Send + 'static,
    ) -> Result<Self, Error> {
        let settings = DynamicRobotSettings { base_joints, ..DynamicRobotSettings::default() };
        let robot = DynamicRobot::new(&model, &settings, start)?;
        let limits = CommandLimits::new(&model, base_joints);
        let (tool, noise) = (model.frame_id(tool)?, Noise(Box::new(noise)));
        Ok(Self { robot, model, tool, held: None, limits, noise, period, refused: 0 })
    }

    /// Returns the number of commands that the robot refused because of its limits or because it had stopped by itself.
    pub fn refused(&self) -> u64 {
        self.refused
    }

    /// Returns the status that the robot reports.
    pub fn status(&self) -> RobotStatus {
        RobotStatus { holds: Some(self.held.is_some()), ..self.robot.status() }
    }

    /// Returns the configuration \[m, rad\].
    pub fn position(&self) -> &[f64] {
        self.robot.simulation().position()
    }

    /// Returns the pose of the tool in the world.
    ///
    /// # Errors
    /// Those of the simulation.
    #[cfg(feature = "ros2")]
    pub(crate) fn tool_pose(&mut self) -> Result<Isometry3<f64>, Error> {
        let q = self.position().to_vec();
        let data = self.robot.simulation_mut().data_mut();
        Ok(data.pose(&self.model, &q)?.world_from(self.tool)?)
    }

    /// Returns true if all joints are at rest.
    pub fn is_at_rest(&self) -> bool {
        self.robot.simulation().velocity().iter().all(|velocity| velocity.abs() < REST)
    }

    /// Checks whether the robot accepts a command.
    ///
    /// # Errors
    /// Why the robot refuses the command; the refusal is counted.
    pub fn check(&mut self, command: &JointCommand) -> Result<(), CommandRefusal> {
        let checked = self.limits.check(command).and_then(|()| {
            if !self.status().is_stopped() {
                Ok(())
            } else if self.is_at_rest() {
                self.limits.check_begin(command)
            } else {
                Err(CommandRefusal::Braking)
            }
        });
        self.refused += u64::from(checked.is_err());
        checked
    }

    /// Moves for one period by a command that was checked.
    ///
    /// # Errors
    /// Those of the simulation.
    pub fn obey(&mut self, command: &JointCommand) -> Result<(), Error> {
        if self.status().is_stopped() {
            self.robot.recover();
        }
        match (command.grip, self.held) {
            (Some(Grip::Close), None) => {
                self.held = Some(self.robot.attach(self.tool, &GraspedObject::default())?);
            }
            (Some(Grip::Open), Some(held)) => {
                self.robot.simulation_mut().data_mut().detach(&self.model, held)?;
                self.held = None;
            }
            _ => {}
        }
        let torque = command.torque.get(self.limits.base_joints()..).unwrap_or_default();
        self.robot.drive(&command.velocity, torque, &[], self.period, &mut self.noise)
    }

    /// Moves for one period without a command, as if it had been lost.
    ///
    /// # Errors
    /// Those of the simulation.
    pub fn miss(&mut self) -> Result<(), Error> {
        self.robot.miss(&[], self.period)
    }

    /// Makes a robot at rest ready for another controller.
    pub fn recover(&mut self) {
        self.robot.recover();
    }
}

impl RobotSide for SimulatedSide {
    type Error = Error;

    fn receive(&mut self, measured: &mut JointMeasurement) -> Result<Received, Error> {
        self.robot.measure(&mut self.noise)?;
        measured.take(self.robot.measured());
        measured.robot = self.status();
        Ok(Received::Fresh)
    }

    fn send(&mut self, command: &JointCommand) -> Result<(), Error> {
        match self.check(command) {
            Ok(()) => self.obey(command),
            Err(_) => self.miss(),
        }
    }

    fn halt(&mut self) -> Result<(), Error> {
        Ok(())
    }
}
