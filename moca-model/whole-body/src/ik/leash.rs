//! How far the commanded state may run ahead of the measured one.

use ahqp_core::{AcceleratedState, JerkLimits, Limits, VelocityInterval};

use crate::error::Error;
use crate::robot::joint::JointKind;
use crate::robot::limits::JointLimits;
use crate::robot::model::Model;

/// The largest following errors, |q* − q| of each joint.
///
/// A robot that follows late by a time T is behind by T times its speed, and one under impedance
/// control gives way by the torque over its stiffness: the leash must leave room for both. A
/// floating base is estimated, not commanded, and has no leash.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leash {
    /// Of joints that turn \[rad\]. Default 0.1.
    pub revolute: f64,
    /// Of joints that slide \[m\]. Default 0.1.
    pub prismatic: f64,
    /// Time constant with which the measured velocity is estimated \[s\]. Default 0.02.
    pub filter_time: f64,
}

impl Default for Leash {
    fn default() -> Self {
        Self { revolute: 0.1, prismatic: 0.1, filter_time: 0.02 }
    }
}

impl Leash {
    /// How far the command of a joint with these limits can be from the measured position, whatever
    /// the robot does \[rad or m\]: the leash, and for a robot that stops suddenly at full speed v what
    /// is covered until that is known, v · filter time, and until the command has come to rest,
    /// v²/(2a) + v a/j. Infinite where the speed or the acceleration is not limited.
    ///
    /// ```
    /// use whole_body::{JointKind, JointLimits, Leash};
    ///
    /// let elbow = JointLimits { velocity: 2.0, acceleration: 10.0, ..JointLimits::UNLIMITED };
    /// let most = Leash::default().bound(JointKind::Revolute, &elbow);
    /// assert!((most - (0.1 + 2.0 * 0.02 + 0.2)).abs() < 1e-12);
    /// ```
    pub fn bound(&self, kind: JointKind, limits: &JointLimits) -> f64 {
        let length = match kind {
            JointKind::Floating => return f64::INFINITY,
            JointKind::Prismatic => self.prismatic,
            JointKind::Revolute | JointKind::Continuous => self.revolute,
        };
        let JointLimits { velocity, acceleration, jerk, .. } = *limits;
        if velocity.is_infinite() || acceleration.is_infinite() {
            return f64::INFINITY;
        }
        let time = self.filter_time + 0.5 * velocity / acceleration + acceleration / jerk;
        length + velocity * time
    }

    /// Checks the ranges.
    ///
    /// # Errors
    /// [`Error::Parameter`] names the first that is out of its range.
    pub fn validate(&self) -> Result<(), Error> {
        for (what, value) in [
            ("the leash of joints that turn", self.revolute),
            ("the leash of joints that slide", self.prismatic),
            ("the filter time of the leash", self.filter_time),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(Error::Parameter { what, value, expected: "positive and finite" });
            }
        }
        Ok(())
    }
}

/// The velocities that keep each joint within its leash.
///
/// Seen from the measured joint, the commanded one is a motion between the ends of the leash: its
/// velocity against the measured one is such that it can still come to rest in front of the end. A
/// robot that follows is not held back, however fast; one that is held lets the command run to the
/// end of the leash and wait there.
#[derive(Debug, Clone)]
pub(super) struct LeashIntervals {
    leash: Leash,
    joints: Vec<Option<LeashedJoint>>,
    /// Of each entry of q̇, as estimated.
    measured_velocity: Vec<f64>,
    last: Vec<f64>,
    pub(super) intervals: Vec<VelocityInterval>,
}

#[derive(Debug, Clone, Copy)]
struct LeashedJoint {
    position: usize,
    limits: JerkLimits,
}

/// What stands for limits that there are not.
const FREE_VELOCITY: f64 = 1e9;
const FREE_ACCELERATION: f64 = 1e14;

impl LeashIntervals {
    pub(super) fn new(leash: Leash, model: &Model, measured: &[f64]) -> Result<Self, Error> {
        leash.validate()?;
        let mut joints = vec![None; model.velocity_count()];
        for joint in model.joints() {
            let length = match joint.kind {
                JointKind::Floating => continue,
                JointKind::Prismatic => leash.prismatic,
                JointKind::Revolute | JointKind::Continuous => leash.revolute,
            };
            let limits = model.limits()[joint.velocity_index];
            // Velocities are limited elsewhere.
            let acceleration = limits.acceleration.min(FREE_ACCELERATION);
            let limits = Limits::new(-length, length, FREE_VELOCITY, acceleration)?
                .with_jerk(limits.jerk)?;
            joints[joint.velocity_index] =
                Some(LeashedJoint { position: joint.position_index, limits });
        }
        let free = VelocityInterval { lower: f64::NEG_INFINITY, upper: f64::INFINITY };
        Ok(Self {
            leash,
            measured_velocity: vec![0.0; joints.len()],
            last: measured.to_vec(),
            intervals: vec![free; joints.len()],
            joints,
        })
    }

    /// Computes the intervals from the commanded and the measured configuration.
    pub(super) fn update(
        &mut self,
        commanded: &[f64],
        velocity: &[f64],
        acceleration: &[f64],
        measured: &[f64],
        period: f64,
    ) {
        let share = period / (period + self.leash.filter_time);
        let estimates = self.measured_velocity.iter_mut().zip(&mut self.intervals);
        for (entry, (joint, (estimate, interval))) in self.joints.iter().zip(estimates).enumerate()
        {
            let Some(LeashedJoint { position, limits }) = *joint else { continue };
            let moved = (measured[position] - self.last[position]) / period;
            *estimate += share * (moved - *estimate);
            let state = AcceleratedState {
                position: commanded[position] - measured[position],
                velocity: velocity[entry] - *estimate,
                acceleration: acceleration[entry],
            };
            let apart = limits.velocity_interval(state, period);
            *interval =
                VelocityInterval { lower: apart.lower + *estimate, upper: apart.upper + *estimate };
        }
        self.last.copy_from_slice(measured);
    }
}
