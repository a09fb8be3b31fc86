//! Commands that a robot refuses.

use moca_model::whole_body::Model;
use moca_model::whole_body::control_loop::JointCommand;

/// Factor by which a command may exceed a limit: it covers rounding, and lists of limits that differ a little.
const MARGIN: f64 = 1.05;
/// Largest speed of a command that begins after a stop \[m/s or rad/s\].
const REST: f64 = 0.02;

/// Reason why a robot refuses a command.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CommandRefusal {
    /// A number exceeds the limit of its joint by more than 5 %.
    #[error("a command with {what} {value:.3} of joint {} of q, which takes at most {limit:.3}", joint + 1)]
    Limit {
        /// `velocity` \[m/s or rad/s\] or `torque` \[N or Nm\].
        what: &'static str,
        /// Index of the joint.
        joint: usize,
        /// Number in the command.
        value: f64,
        /// Limit of the joint.
        limit: f64,
    },
    /// The robot has stopped by itself and still moves.
    #[error("a command while the robot brakes that stopped by itself")]
    Braking,
    /// The robot stopped by itself, and the command does not begin at rest.
    #[error(
        "a command that asks for {speed:.3} m/s or rad/s of a robot that stopped by itself; begin at rest, \
         at most {REST}"
    )]
    NotAtRest {
        /// Speed of the base's fastest axis.
        speed: f64,
    },
}

/// Limits that the robot's side applies to commands.
#[derive(Clone, Debug)]
pub(crate) struct CommandLimits {
    /// Largest speed and torque of each joint.
    joints: Vec<[f64; 2]>,
    /// Number of the first joints, which take velocities.
    base_joints: usize,
}

impl CommandLimits {
    /// Creates the limits of a robot: those of its URDF with a margin of 5 %.
    pub(crate) fn new(model: &Model, base_joints: usize) -> Self {
        let limits = model.limits().iter();
        let joints = limits.map(|limits| [limits.velocity, limits.effort]).collect();
        Self { joints, base_joints }
    }

    /// Returns the number of the first joints, which take velocities.
    pub(crate) fn base_joints(&self) -> usize {
        self.base_joints
    }

    /// Checks the velocities of all joints and the torques of the arm.
    ///
    /// # Errors
    /// [`CommandRefusal::Limit`] for the first number that is out of range.
    pub(crate) fn check(&self, command: &JointCommand) -> Result<(), CommandRefusal> {
        let joints = self.joints.iter().zip(command.velocity.iter().zip(&command.torque));
        for (joint, ([fastest, strongest], (velocity, torque))) in joints.enumerate() {
            let parts = [("velocity", velocity, fastest), ("torque", torque, strongest)];
            let driven = if joint < self.base_joints { 1 } else { 2 };
            for (what, value, limit) in parts.into_iter().take(driven) {
                let within = value.abs() <= MARGIN * limit;
                if !within {
                    return Err(CommandRefusal::Limit {
                        what,
                        joint,
                        value: *value,
                        limit: *limit,
                    });
                }
            }
        }
        Ok(())
    }

    /// Checks that a command after a stop begins at rest, as far as joints take velocities.
    ///
    /// # Errors
    /// [`CommandRefusal::NotAtRest`]
    pub(crate) fn check_begin(&self, command: &JointCommand) -> Result<(), CommandRefusal> {
        let base = command.velocity.iter().take(self.base_joints);
        let speed = base.fold(0.0, |most: f64, velocity| most.max(velocity.abs()));
        if speed <= REST { Ok(()) } else { Err(CommandRefusal::NotAtRest { speed }) }
    }
}
