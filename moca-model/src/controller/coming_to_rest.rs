//! Braking.

use nalgebra::Vector6;

use super::Controller;
use crate::command::Outcome;
use crate::motion_limits::{TickTimes, brake, nearest_to_rest};

impl Controller {
    /// Sets every joint and the desired pose as near to rest as their limits allow.
    pub(super) fn brake(&mut self) {
        self.go_towards_rest(1.0);
        self.command.outcome = Outcome::Braking;
    }

    /// Moves the velocities by this share towards those nearest to rest.
    pub(super) fn go_towards_rest(&mut self, share: f64) {
        if share == 0.0 {
            return;
        }
        let (_, desired) = self.intervals.split_at(self.braking.len());
        let velocities = self.command.joint_velocity.iter_mut().zip(&self.braking);
        velocities.for_each(|(velocity, braking)| *velocity += share * (braking - *velocity));
        for (velocity, interval) in self.command.desired_twist.iter_mut().zip(desired) {
            *velocity += share * (nearest_to_rest(interval) - *velocity);
        }
        self.command.slack *= 1.0 - share;
    }

    /// Brakes at the limits of acceleration and jerk, whatever the tasks ask.
    pub(super) fn halt(&mut self, TickTimes { elapsed, step }: TickTimes) {
        brake(&self.joint_braking, &self.acceleration, step, &mut self.command.joint_velocity);
        let twist = self.command.desired_twist.as_mut_slice();
        brake(&self.desired_braking, &[0.0; 6], step, twist);
        self.command.slack = Vector6::zeros();
        self.command.outcome = Outcome::Braking;
        self.safety.wait(self.clock.age(), elapsed);
    }
}
