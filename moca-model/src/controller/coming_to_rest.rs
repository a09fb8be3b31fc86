//! Ticks in which the robot brakes.

use nalgebra::Vector6;

use super::Controller;
use crate::command::Outcome;
use crate::motion_limits::{TickTimes, brake, nearest_to_rest};

impl Controller {
    /// Every joint, and the desired pose, as near to rest as its limits allow.
    pub(super) fn brake(&mut self) {
        self.go_towards_rest();
        self.command.outcome = Outcome::Braking;
    }

    pub(super) fn go_towards_rest(&mut self) {
        let (_, desired) = self.intervals.split_at(self.braking.len());
        self.command.joint_velocity.copy_from_slice(&self.braking);
        for (velocity, interval) in self.command.desired_twist.iter_mut().zip(desired) {
            *velocity = nearest_to_rest(interval);
        }
        self.command.slack = Vector6::zeros();
    }

    /// Brakes at the limits of acceleration, whatever else holds.
    pub(super) fn halt(&mut self, TickTimes { elapsed, step }: TickTimes) {
        brake(&self.joint_braking, &self.acceleration, step, &mut self.command.joint_velocity);
        let twist = self.command.desired_twist.as_mut_slice();
        brake(&self.desired_braking, &[0.0; 6], step, twist);
        self.command.slack = Vector6::zeros();
        self.command.outcome = Outcome::Braking;
        self.safety.wait(self.clock.age(), elapsed);
    }
}
