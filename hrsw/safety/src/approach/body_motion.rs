//! Motion of a body of the robot.

use nalgebra::{Vector3, Vector6};

use super::joint_changes::JointChanges;
use crate::approach::bodies::RobotBody;
use crate::approach::joint_motion::JointMotion;

/// Motion of a body at the last commanded velocity, as the twist of the point o as if fixed to the
/// body.
#[derive(Debug, Clone, Copy)]
pub(super) struct BodyMotion {
    joints: usize,
    pub(super) twist: Vector6<f64>,
    /// The base's share of the twist.
    pub(super) base: Vector6<f64>,
    /// Upper bound of the speed of every point of the body \[m/s\].
    pub(super) fastest: f64,
    /// Upper bound of the increase of the speed of approach within this tick \[m/s\].
    pub(super) change: f64,
    /// True if `change` is the tightest known bound, which takes longer to compute.
    is_exact: bool,
}

impl BodyMotion {
    /// Computes the motion of a body. The first `base_joints` joints are the base's. `before` is
    /// the motion of another body in the same tick.
    pub(super) fn new(
        motion: &JointMotion<'_>,
        body: &RobotBody,
        base_joints: usize,
        changes: &JointChanges,
        before: Option<&Self>,
    ) -> Self {
        // Bodies that the same joints move have the same twist.
        let (twist, base) = match before.filter(|before| before.joints == body.joints) {
            Some(before) => (before.twist, before.base),
            None => (
                motion.twist(motion.velocity, body.joints),
                motion.twist(motion.velocity, body.joints.min(base_joints)),
            ),
        };
        let (linear, angular) = (twist.fixed_rows::<3>(0), twist.fixed_rows::<3>(3));
        let (arm, reach) = (body.capsule.middle() - motion.origin, body.capsule.reach());
        let fastest = (linear + angular.cross(&arm)).norm() + angular.norm() * reach;
        let change = changes.most(motion, body);
        Self { joints: body.joints, twist, base, fastest, change, is_exact: false }
    }

    /// Tightens the change to the sum of what each joint can do to this body.
    pub(super) fn tell_change(&mut self, motion: &JointMotion<'_>, body: &RobotBody) {
        let Some(change) = motion.change.filter(|_| !self.is_exact) else { return };
        let (arm, reach) = (body.capsule.middle() - motion.origin, body.capsule.reach());
        let of_joint = |([linear, angular], change): ([Vector3<f64>; 2], &f64)| {
            let of_middle = linear + angular.cross(&arm);
            change * (of_middle.norm() + angular.norm() * reach)
        };
        self.change = motion.columns(body.joints).zip(change).map(of_joint).sum();
        self.is_exact = true;
    }

    /// Returns the speed of a point of the body along the force of a `wrench` about o \[m/s\].
    pub(super) fn along(&self, wrench: &Vector6<f64>) -> f64 {
        self.twist.dot(wrench)
    }

    /// Returns the base's share of [`along`](Self::along).
    pub(super) fn base_along(&self, wrench: &Vector6<f64>) -> f64 {
        self.base.dot(wrench)
    }
}
