//! A pair that may get a row.

use nalgebra::Vector6;

use super::{JointMotion, Nearest};
use crate::distance::Proximity;
use crate::separation::SeparationSettings;

/// A pair with the place where it is nearest.
#[derive(Debug, Clone, Copy)]
pub(super) struct Candidate {
    /// With the deceleration of those joints that bring the pair nearer.
    pub(super) settings: SeparationSettings,
    pub(super) robot: usize,
    pub(super) other: usize,
    pub(super) robot_joints: usize,
    pub(super) other_joints: usize,
    pub(super) near: Proximity,
    /// As measured, without the uncertainty.
    pub(super) human_speed: f64,
    pub(super) limit: f64,
    /// How much faster the pair may come nearer than at the last commanded velocity \[m/s\].
    pub(super) headroom: f64,
    pub(super) contact: bool,
}

impl Candidate {
    /// −∂d/∂q: how fast the pair comes nearer.
    pub(super) fn write(&self, motion: &JointMotion<'_>, row: &mut [f64]) {
        let toward = self.near.gradient_first(&motion.origin);
        let away = self.near.gradient_second(&motion.origin);
        for (j, (out, column)) in row.iter_mut().zip(motion.jacobian.column_iter()).enumerate() {
            if j < self.robot_joints {
                *out -= column.dot(&toward);
            }
            if j < self.other_joints {
                *out -= column.dot(&away);
            }
        }
    }

    /// Returns true if the pair is nearer than a robot at rest should be.
    pub(super) fn is_undercut(&self) -> bool {
        self.near.distance < self.settings.protective_distance(self.human_speed, 0.0)
    }

    /// How fast the robot may come nearer at `velocity` \[m/s\] to a person who lies up to `error` \[m\] beside
    /// where they are taken to be.
    pub(super) fn worst_approach(
        &self,
        motion: &JointMotion<'_>,
        velocity: &[f64],
        error: f64,
    ) -> f64 {
        let mut twist = Vector6::zeros();
        let joints = motion.jacobian.column_iter().zip(velocity);
        for (column, &velocity) in joints.take(self.robot_joints) {
            twist += column * velocity;
        }
        let Proximity { normal, on_first, on_second, .. } = self.near;
        let (linear, angular) = (twist.fixed_rows::<3>(0), twist.fixed_rows::<3>(3));
        let of_point = linear + angular.cross(&(on_first - motion.origin));
        let approach = -of_point.dot(&normal);
        let across = (of_point + normal * approach).norm();
        // The direction to the person is off by the angle under which the error is seen.
        let sine = error / (on_first - on_second).norm().max(error);
        approach + across * sine + angular.norm() * error
    }

    pub(super) fn seen(&self) -> Nearest {
        let approach = self.limit - self.headroom;
        Nearest {
            robot: self.robot,
            other: self.other,
            distance: self.near.distance,
            required: self.settings.protective_distance(self.human_speed, approach),
            approach,
        }
    }
}
