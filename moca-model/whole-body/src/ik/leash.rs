//! How far the commanded state may run ahead of the measured one.

use ahqp_core::{AcceleratedState, JerkLimits, Limits, VelocityInterval};

use super::differential::Ik;
use crate::error::Error;
use crate::robot::joint::JointKind;
use crate::robot::limits::JointLimits;
use crate::robot::model::Model;

/// The largest following errors, |q* − q| of each joint.
///
/// A robot that follows late by a time T is behind by T times its speed, and one under impedance
/// control gives way by the torque over its stiffness: the leash must leave room for both.
///
/// A floating base has the leash along and about the world's axes. It is estimated, and estimates
/// drift and jump: at the end of the leash its command waits, and goes no farther, but is never drawn
/// back or taken along. Turned about several axes at once it goes up to 5 % farther.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leash {
    /// Of joints that turn, and a floating base's rotation \[rad\]. Default 0.1.
    pub revolute: f64,
    /// Of joints that slide, and a floating base's position \[m\]. Default 0.1.
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
    /// v²/(2a) + v a/j. Infinite where the speed or the acceleration is not limited, and for floating
    /// bases, which only stop at the leash.
    ///
    /// ```
    /// use whole_body::ik::Leash;
    /// use whole_body::robot::{JointKind, JointLimits};
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
    /// [`Error::Value`] names the first that is out of its range.
    pub fn validate(&self) -> Result<(), Error> {
        for (what, value) in [
            ("the leash of joints that turn", self.revolute),
            ("the leash of joints that slide", self.prismatic),
            ("the filter time of the leash", self.filter_time),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(Error::value(what, value, "positive and finite"));
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
    joints: Vec<LeashedJoint>,
    /// Of each entry of q̇, as estimated.
    measured_velocity: Vec<f64>,
    last: Vec<f64>,
    /// By entry of q̇: from the measured configuration to the commanded one, and from the last measured
    /// one to this.
    apart: Vec<f64>,
    moved: Vec<f64>,
    pub(super) intervals: Vec<VelocityInterval>,
}

#[derive(Debug, Clone, Copy)]
struct LeashedJoint {
    limits: JerkLimits,
    /// Whether the command comes back where the joint is beyond the leash.
    returns: bool,
}

/// What stands for limits that there are not.
const FREE_VELOCITY: f64 = 1e9;
const FREE_ACCELERATION: f64 = 1e14;

impl LeashIntervals {
    pub(super) fn new(leash: Leash, model: &Model, measured: &[f64]) -> Result<Self, Error> {
        leash.validate()?;
        let mut joints = Vec::with_capacity(model.velocity_count());
        for joint in model.joints() {
            let (lengths, returns) = match joint.kind {
                JointKind::Floating => (&[leash.prismatic, leash.revolute][..], false),
                JointKind::Prismatic => (&[leash.prismatic][..], true),
                JointKind::Revolute | JointKind::Continuous => (&[leash.revolute][..], true),
            };
            for entry in 0..joint.kind.velocities() {
                let length = lengths[entry / 3];
                let limits = model.limits()[joint.velocity_index + entry];
                // Velocities are limited elsewhere.
                let acceleration = limits.acceleration.min(FREE_ACCELERATION);
                let limits = Limits::new(-length, length, FREE_VELOCITY, acceleration)?
                    .with_jerk(limits.jerk)?;
                joints.push(LeashedJoint { limits, returns });
            }
        }
        let free = VelocityInterval { lower: f64::NEG_INFINITY, upper: f64::INFINITY };
        Ok(Self {
            leash,
            measured_velocity: vec![0.0; joints.len()],
            last: measured.to_vec(),
            apart: vec![0.0; joints.len()],
            moved: vec![0.0; joints.len()],
            intervals: vec![free; joints.len()],
            joints,
        })
    }

    /// Computes the intervals from the commanded configuration, the motion of the last step and the
    /// measured configuration.
    pub(super) fn update(
        &mut self,
        commanded: &[f64],
        ik: &Ik,
        measured: &[f64],
        period: f64,
    ) -> Result<(), Error> {
        ik.model().difference(measured, commanded, &mut self.apart)?;
        ik.model().difference(&self.last, measured, &mut self.moved)?;
        let share = period / (period + self.leash.filter_time);
        let estimates = self.measured_velocity.iter_mut().zip(&mut self.intervals);
        for (entry, (joint, (estimate, interval))) in self.joints.iter().zip(estimates).enumerate()
        {
            *estimate += share * (self.moved[entry] / period - *estimate);
            let state = AcceleratedState {
                position: self.apart[entry],
                velocity: ik.velocity()[entry] - *estimate,
                acceleration: ik.acceleration()[entry],
            };
            let apart = joint.limits.velocity_interval(state, period);
            let (lower, upper) = (apart.lower + *estimate, apart.upper + *estimate);
            *interval = if joint.returns {
                VelocityInterval { lower, upper }
            } else {
                VelocityInterval { lower: lower.min(0.0), upper: upper.max(0.0) }
            };
        }
        self.last.copy_from_slice(measured);
        Ok(())
    }
}
