//! Conversion of commands to messages, and back on the robot's side.

use std::time::SystemTime;

use moca_model::MOCA_BASE_JOINTS;
use moca_model::whole_body::control_loop::JointCommand;
use nalgebra::{Rotation2, Vector2};

use super::BASE_FRAME;
use super::measurements::{check_frame, check_size, check_twist};
use super::messages::{Float64MultiArray, Twist, TwistStamped, Vector3};
use super::refusal::Refusal;
use super::stamps::Stamps;
use super::topic::JointInterface;

/// Returns the base's part of q̇ in the axes of a base with this `yaw` \[rad\]: (ẋ, ẏ, θ̇) \[m/s, rad/s\].
pub(super) fn base_velocity(velocity: &[f64], yaw: f64) -> [f64; MOCA_BASE_JOINTS] {
    let [x, y, turn] = velocity.first_chunk().copied().unwrap_or_default();
    let own = Rotation2::new(-yaw) * Vector2::new(x, y);
    [own.x, own.y, turn]
}

/// Returns the part of a command for an arm behind so many joints of a base.
pub(super) fn joint_values(
    command: &JointCommand,
    base_joints: usize,
    interface: JointInterface,
) -> &[f64] {
    let all = match interface {
        JointInterface::Effort => &command.torque,
        JointInterface::Velocity => &command.velocity,
        JointInterface::Position => &command.position,
    };
    all.get(base_joints..).unwrap_or_default()
}

impl From<[f64; MOCA_BASE_JOINTS]> for Twist {
    fn from([x, y, turn]: [f64; MOCA_BASE_JOINTS]) -> Self {
        let (linear, angular) =
            (Vector3 { x, y, z: 0.0 }, Vector3 { z: turn, ..Vector3::default() });
        Self { linear, angular }
    }
}

/// Commands that a robot receives by ROS: twists of its base and torques of its arm.
#[derive(Clone, Debug)]
pub struct Commands {
    stamps: Stamps,
    /// Twist in the base's axes.
    twist: [f64; MOCA_BASE_JOINTS],
    effort: Vec<f64>,
}

impl Commands {
    /// Creates the commands of an arm with this number of joints, before the first message.
    pub fn new(arm_joints: usize) -> Self {
        let twist = [0.0; MOCA_BASE_JOINTS];
        Self { stamps: Stamps::of_robot(), twist, effort: vec![0.0; arm_joints] }
    }

    /// Takes a twist in the base's axes that came at time `now`. Returns its age \[s\].
    ///
    /// # Errors
    /// Why the twist is refused; the numbers are then unchanged.
    pub fn take_twist(&mut self, twist: &TwistStamped, now: SystemTime) -> Result<f64, Refusal> {
        check_frame(&twist.header.frame_id, BASE_FRAME)?;
        check_twist(&twist.twist)?;
        let age = self.stamps.admit(twist.header.stamp, now)?;
        let Twist { linear, angular } = twist.twist;
        self.twist = [linear.x, linear.y, angular.z];
        Ok(age)
    }

    /// Takes the torques of the arm's joints, in their order.
    ///
    /// # Errors
    /// Why the torques are refused; the numbers are then unchanged.
    pub fn take_effort(&mut self, effort: &Float64MultiArray) -> Result<(), Refusal> {
        check_size("effort", &effort.data, self.effort.len())?;
        if !effort.data.iter().all(|number| number.is_finite()) {
            return Err(Refusal::NotFinite { what: "effort" });
        }
        self.effort.copy_from_slice(&effort.data);
        Ok(())
    }

    /// Writes the command of a robot whose base has this `yaw` \[rad\]: velocities of the base along the world's axes,
    /// and torques of the arm.
    pub fn write(&self, yaw: f64, command: &mut JointCommand) {
        let [x, y, turn] = self.twist;
        let world = Rotation2::new(yaw) * Vector2::new(x, y);
        if let Some(base) = command.velocity.first_chunk_mut() {
            *base = [world.x, world.y, turn];
        }
        for (own, effort) in command.torque.iter_mut().skip(MOCA_BASE_JOINTS).zip(&self.effort) {
            *own = *effort;
        }
    }
}
