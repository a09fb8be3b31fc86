//! The limit on the following error between commanded and measured state.

use ahqp_core::{AcceleratedState, JerkLimits, Limits, VelocityInterval};

use super::differential::Ik;
use crate::error::Error;
use crate::robot::joint::JointKind;
use crate::robot::limits::JointLimits;
use crate::robot::model::Model;

/// The largest following errors |q* − q| of joints.
///
/// A robot that follows with a delay T is behind by T times its speed. A robot under impedance control yields by the
/// torque over its stiffness. The following-error limit must leave room for both.
///
/// A floating base has the following-error limit along and about the world's axes. Its measured pose is an estimate,
/// which drifts and jumps. At the following-error limit its command waits, but is never drawn back or taken along. A
/// rotation about several axes at once may go up to 5 % beyond the following-error limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FollowingErrorLimit {
    /// Following-error limit of revolute joints and of a floating base's rotation \[rad\]. Default 0.1.
    pub revolute: f64,
    /// Following-error limit of prismatic joints and of a floating base's position \[m\]. Default 0.1.
    pub prismatic: f64,
    /// Time constant of the estimate of the measured velocity \[s\]. Default 0.02.
    pub filter_time: f64,
}

impl Default for FollowingErrorLimit {
    fn default() -> Self {
        Self { revolute: 0.1, prismatic: 0.1, filter_time: 0.02 }
    }
}

impl FollowingErrorLimit {
    /// The largest possible following error of a joint with these limits, whatever the robot does \[rad or m\].
    ///
    /// It is the following-error limit and the overrun of a robot that stops suddenly at full speed v. The overrun is v
    /// · filter time until the stop is known, and v²/(2a) + v a/j until the command is at rest. The bound is infinite
    /// where speed or acceleration is not limited, and for floating bases, whose commands only wait at the
    /// following-error limit.
    ///
    /// ```
    /// use whole_body::ik::FollowingErrorLimit;
    /// use whole_body::robot::{JointKind, JointLimits};
    ///
    /// let elbow = JointLimits { velocity: 2.0, acceleration: 10.0, ..JointLimits::UNLIMITED };
    /// let most = FollowingErrorLimit::default().bound(JointKind::Revolute, &elbow);
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
            ("the following-error limit of joints that turn", self.revolute),
            ("the following-error limit of joints that slide", self.prismatic),
            ("the filter time of the following-error limit", self.filter_time),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(Error::value(what, value, "positive and finite"));
            }
        }
        Ok(())
    }
}

/// The velocities that keep each joint within its following-error limit.
///
/// Relative to the measured joint, the commanded joint moves between the ends of the following-error limit. Its
/// velocity relative to the measured one must allow it to come to rest before the end. So a robot that follows is never
/// slowed down. The command of a held robot runs to the following-error limit and waits there.
#[derive(Debug, Clone)]
pub(super) struct FollowingErrorIntervals {
    following_error: FollowingErrorLimit,
    joints: Vec<FollowingJoint>,
    /// Estimated measured q̇.
    measured_velocity: Vec<f64>,
    last: Vec<f64>,
    /// Displacements from the measured configuration to the commanded one, and from the last measured one to this one.
    apart: Vec<f64>,
    moved: Vec<f64>,
    pub(super) intervals: Vec<VelocityInterval>,
}

#[derive(Debug, Clone, Copy)]
struct FollowingJoint {
    limits: JerkLimits,
    /// Whether the command returns where the joint is beyond the following-error limit.
    returns: bool,
}

/// Values that stand for missing limits.
const FREE_VELOCITY: f64 = 1e9;
const FREE_ACCELERATION: f64 = 1e14;

impl FollowingErrorIntervals {
    pub(super) fn new(
        following_error: FollowingErrorLimit,
        model: &Model,
        measured: &[f64],
    ) -> Result<Self, Error> {
        following_error.validate()?;
        let mut joints = Vec::with_capacity(model.velocity_count());
        for joint in model.joints() {
            let (lengths, returns) = match joint.kind {
                JointKind::Floating => {
                    (&[following_error.prismatic, following_error.revolute][..], false)
                }
                JointKind::Prismatic => (&[following_error.prismatic][..], true),
                JointKind::Revolute | JointKind::Continuous => {
                    (&[following_error.revolute][..], true)
                }
            };
            for entry in 0..joint.kind.velocities() {
                let length = lengths[entry / 3];
                let limits = model.limits()[joint.velocity_index + entry];
                // Velocities are limited elsewhere.
                let acceleration = limits.acceleration.min(FREE_ACCELERATION);
                let limits = Limits::new(-length, length, FREE_VELOCITY, acceleration)?
                    .with_jerk(limits.jerk)?;
                joints.push(FollowingJoint { limits, returns });
            }
        }
        let free = VelocityInterval { lower: f64::NEG_INFINITY, upper: f64::INFINITY };
        Ok(Self {
            following_error,
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
        let share = period / (period + self.following_error.filter_time);
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
