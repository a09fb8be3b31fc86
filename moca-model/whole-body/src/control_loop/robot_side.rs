//! The interface of a robot.

use crate::robot::model::Model;

/// Measurements of a robot, one element for each entry of q and q̇, and its status.
#[derive(Debug, Clone, PartialEq)]
pub struct JointMeasurement {
    /// q \[m or rad\].
    pub position: Vec<f64>,
    /// q̇ \[m/s or rad/s\].
    pub velocity: Vec<f64>,
    /// Torques at the output of the gears \[N or Nm\]; `None` for a joint without a torque sensor.
    pub torque: Vec<Option<f64>>,
    /// The status that the robot reports.
    pub robot: RobotStatus,
    /// Time since this measurement came from the robot \[s\], zero if it came in this tick. The loop writes it.
    pub age: f64,
}

/// The status that a robot reports. `None` stands for what it does not report.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct RobotStatus {
    /// Mode of the robot: it takes commands, or the reason why it does not.
    pub mode: Option<RobotMode>,
    /// True if the robot took the last command before this measurement.
    pub took_command: Option<bool>,
    /// True if the gripper holds something.
    pub holds: Option<bool>,
}

/// Order to the gripper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Grip {
    /// It opens, or stays open.
    Open,
    /// It closes, or stays closed.
    Close,
}

/// Mode of a robot: it takes commands, or the reason why it does not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum RobotMode {
    /// The robot takes commands.
    Running,
    /// The robot stopped by itself because commands were lost or because of an internal error.
    Stopped,
    /// The robot stopped by itself because of a contact or a limit.
    Reflex,
    /// Somebody stopped the robot by an enabling device or an emergency stop.
    UserStop,
}

impl RobotStatus {
    /// Returns true if the robot reports that it takes no commands.
    pub fn is_stopped(self) -> bool {
        self.mode.is_some_and(|mode| mode != RobotMode::Running)
    }
}

/// A command to a robot, one element for each entry of q and q̇. The robot decides which of them each joint follows.
#[derive(Debug, Clone, PartialEq)]
pub struct JointCommand {
    /// q* \[m or rad\].
    pub position: Vec<f64>,
    /// q̇* \[m/s or rad/s\].
    pub velocity: Vec<f64>,
    /// τ* \[N or Nm\]. Zero for joints that take no torque.
    pub torque: Vec<f64>,
    /// Order to the gripper; `None` leaves it as it is.
    pub grip: Option<Grip>,
}

impl JointMeasurement {
    /// Creates a command to rest at the neutral configuration without torques.
    pub fn at_rest(model: &Model) -> Self {
        Self::resting(model.neutral(), model.velocity_count())
    }

    /// Creates a measurement at rest at `position` \[rad or m\], with `joints` entries of q̇, without
    /// torques and without a status.
    pub fn resting(position: Vec<f64>, joints: usize) -> Self {
        Self {
            position,
            velocity: vec![0.0; joints],
            torque: vec![None; joints],
            robot: RobotStatus::default(),
            age: 0.0,
        }
    }

    /// Takes the values of a measurement of the same robot. Allocates nothing.
    pub fn take(&mut self, other: &Self) {
        self.position.clone_from(&other.position);
        self.velocity.clone_from(&other.velocity);
        self.torque.clone_from(&other.torque);
        (self.robot, self.age) = (other.robot, other.age);
    }
}

impl JointCommand {
    /// Creates a command to rest at the measured configuration without torques.
    pub fn at_rest(measured: &JointMeasurement) -> Self {
        let none = vec![0.0; measured.velocity.len()];
        Self {
            position: measured.position.clone(),
            velocity: none.clone(),
            torque: none,
            grip: None,
        }
    }
}

/// Result of a look for a measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Received {
    /// A measurement newer than the last one.
    Fresh,
    /// No new measurement.
    Nothing,
}

/// The robot's side of a loop: a driver, a connection, a simulation.
///
/// All calls come from one thread, once a period each. They must return well within the period and never wait for the
/// robot.
pub trait RobotSide {
    /// A failure of the robot or the connection, after which the loop must end.
    type Error;

    /// Writes the newest measurement into `measured`, if one has come.
    ///
    /// # Errors
    /// The robot cannot be reached.
    fn receive(&mut self, measured: &mut JointMeasurement) -> Result<Received, Self::Error>;

    /// Sends a command.
    ///
    /// # Errors
    /// The robot cannot be reached.
    fn send(&mut self, command: &JointCommand) -> Result<(), Self::Error>;

    /// Brings the robot to a halt by its brakes, or by whatever holds it without commands. This is the last call.
    ///
    /// # Errors
    /// The robot cannot be reached.
    fn halt(&mut self) -> Result<(), Self::Error>;
}
