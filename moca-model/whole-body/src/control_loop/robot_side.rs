//! The robot as a loop sees it.

use crate::robot::model::Model;

/// What a robot measures, one element an entry of q and q̇.
#[derive(Debug, Clone, PartialEq)]
pub struct JointMeasurement {
    /// q \[m or rad\].
    pub position: Vec<f64>,
    /// q̇ \[m/s or rad/s\].
    pub velocity: Vec<f64>,
    /// Of joints that measure none zero \[N or Nm\].
    pub torque: Vec<f64>,
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
    /// At rest at the neutral configuration.
    pub fn at_rest(model: &Model) -> Self {
        let none = vec![0.0; model.velocity_count()];
        Self { position: model.neutral(), velocity: none.clone(), torque: none }
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
