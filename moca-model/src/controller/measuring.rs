//! Measurement of the robot, and the configuration that tasks see.

use hrsw_safety::Fault;
use whole_body::torque::Following;

use super::Controller;
use crate::following_error::FollowingErrorLimit;
use crate::robot::moca::MOCA_BASE_JOINTS;

/// Time constant with which the commanded place of the base approaches the measured one \[s\]. It is long against the
/// noise of odometry and short against the slip of wheels.
const ODOMETRY: f64 = 0.15;

impl Controller {
    /// Computes tasks at the commanded positions of these joints from now on. They follow positions, by torques.
    pub(crate) fn follow_positions(&mut self, joints: &[usize]) {
        for (index, follows) in self.follows_position.iter_mut().enumerate() {
            *follows = joints.contains(&index);
        }
    }

    /// Takes the velocities of the joints, as measured or predicted.
    pub(crate) fn set_measured_velocity(&mut self, velocity: &[f64]) {
        self.measured_velocity.clear();
        self.measured_velocity.extend_from_slice(velocity);
    }

    /// Takes the measured configuration and keeps the commanded state near it. Returns false if it cannot be used.
    pub(super) fn measure(&mut self, configuration: &[f64], elapsed: f64) -> bool {
        // An error would allocate its message.
        if !self.robot.model().is_configuration(configuration) {
            return false;
        }
        let tool = self.robot.world_from_tool().translation.vector;
        let Ok(following) = self.following_error.clamp(
            &mut self.command,
            configuration,
            &self.follows_position,
            &tool,
        ) else {
            return false;
        };
        self.refer(configuration, following, elapsed);
        let commanded = self.follows_position.iter().zip(&self.command.joint_position);
        for (reference, (follows, commanded)) in self.reference.iter_mut().zip(commanded) {
            if *follows {
                *reference = *commanded;
            }
        }
        if self.robot.update(&self.reference).is_err() {
            return false;
        }
        if let [_, _, yaw, ..] = configuration {
            self.yaw = *yaw;
        }
        if following == Following::Reached {
            self.report(Fault::FollowingError);
        }
        let (desired, actual) = (&mut self.command.desired, self.robot.world_from_hand());
        FollowingErrorLimit::clamp_pose(desired, &actual, following);
        true
    }

    /// Sets the configuration that tasks see. The base's part is commanded and approaches the measured one slowly, so
    /// that noise of odometry does not reach the command.
    fn refer(&mut self, configuration: &[f64], following: Following, elapsed: f64) {
        let base = self.settings.base.map_or(0, |_| MOCA_BASE_JOINTS);
        let base = if following == Following::Follows { base } else { 0 };
        let drawn = -(-elapsed / ODOMETRY).exp_m1();
        let joints = self.reference.iter_mut().zip(configuration).zip(&self.command.joint_velocity);
        for (index, ((reference, measured), velocity)) in joints.enumerate() {
            let expected = *reference + velocity * elapsed;
            *reference =
                if index < base { expected + drawn * (measured - expected) } else { *measured };
        }
    }
}
