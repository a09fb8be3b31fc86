//! The robot as a loop sees it.

use crate::robot::model::Model;

/// What a robot measures, one element an entry of q and q̇, and what it says of itself.
#[derive(Debug, Clone, PartialEq)]
pub struct JointMeasurement {
    /// q \[m or rad\].
    pub position: Vec<f64>,
    /// q̇ \[m/s or rad/s\].
    pub velocity: Vec<f64>,
    /// Torques behind the gears \[N or Nm\]; none for a joint that measures none.
    pub torque: Vec<Option<f64>>,
    /// What the robot says of itself.
    pub robot: RobotStatus,
    /// Time since this came from the robot \[s\]: zero for a measurement of this tick. The loop writes it.
    pub age: f64,
}

/// What a robot says of itself; none for what it does not say.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct RobotStatus {
    /// Whether it takes commands, or why it does not.
    pub mode: Option<RobotMode>,
    /// Whether it took the command before this measurement.
    pub took_command: Option<bool>,
}

/// Whether a robot takes commands, or why it does not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum RobotMode {
    /// It takes commands.
    Running,
    /// It stopped by itself, for lost commands or an error of its own.
    Stopped,
    /// It stopped by itself for a contact or a limit.
    Reflex,
    /// Somebody stopped it, by an enabling device or an emergency stop.
    UserStop,
}

impl RobotStatus {
    /// Returns true if the robot says that it takes no commands.
    pub fn is_stopped(self) -> bool {
        self.mode.is_some_and(|mode| mode != RobotMode::Running)
    }
}

/// What a robot is told, one element an entry of q and q̇. Which of them a joint follows is the robot's.
#[derive(Debug, Clone, PartialEq)]
pub struct JointCommand {
    /// q* \[m or rad\].
    pub position: Vec<f64>,
    /// q̇* \[m/s or rad/s\].
    pub velocity: Vec<f64>,
    /// Of joints that take none zero \[N or Nm\].
    pub torque: Vec<f64>,
}

impl JointMeasurement {
    /// At rest at the neutral configuration, without torques.
    pub fn at_rest(model: &Model) -> Self {
        Self::resting(model.neutral(), model.velocity_count())
    }

    /// At rest at `position`, with `joints` entries of q̇, without torques and without a word of the robot's.
    pub fn resting(position: Vec<f64>, joints: usize) -> Self {
        Self {
            position,
            velocity: vec![0.0; joints],
            torque: vec![None; joints],
            robot: RobotStatus::default(),
            age: 0.0,
        }
    }
}

impl JointCommand {
    /// To rest at a measured configuration, without torques.
    pub fn at_rest(measured: &JointMeasurement) -> Self {
        let none = vec![0.0; measured.velocity.len()];
        Self { position: measured.position.clone(), velocity: none.clone(), torque: none }
    }
}

/// Whether a measurement has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Received {
    /// A newer one than before.
    Fresh,
    /// None.
    Nothing,
}

/// The robot's side of a loop: a driver, a connection, a simulation.
///
/// Calls come from one thread, once a period each, and must return well within it: neither may wait for the
/// robot.
pub trait RobotSide {
    /// What can go wrong with it, so that the loop must end.
    type Error;

    /// Writes the newest measurement that has come into `measured`.
    ///
    /// # Errors
    /// A robot that cannot be reached any more.
    fn receive(&mut self, measured: &mut JointMeasurement) -> Result<Received, Self::Error>;

    /// Sends a command.
    ///
    /// # Errors
    /// A robot that cannot be reached any more.
    fn send(&mut self, command: &JointCommand) -> Result<(), Self::Error>;

    /// No command comes any more: brakes, or whatever holds the robot without them. It is the last call.
    ///
    /// # Errors
    /// A robot that cannot be reached any more.
    fn halt(&mut self) -> Result<(), Self::Error>;
}
