//! How a body of the robot moves.

use nalgebra::{Const, MatrixView, Vector3, Vector6};

use super::{JointMotion, RobotBody};

/// How a body moves at the last commanded velocity: the twist of the point o as if fixed to it.
#[derive(Debug, Clone, Copy)]
pub(super) struct BodyMotion {
    pub(super) twist: Vector6<f64>,
    /// The part of it that is the base's.
    pub(super) base: Vector6<f64>,
    /// The speed of none of its points is larger \[m/s\].
    pub(super) fastest: f64,
    /// By no more than this it may come nearer faster within this tick \[m/s\].
    pub(super) change: f64,
}

type Column<'a> = MatrixView<'a, f64, Const<6>, Const<1>, Const<1>, Const<6>>;

impl BodyMotion {
    pub(super) fn new(motion: &JointMotion<'_>, body: &RobotBody, base_joints: usize) -> Self {
        let (mut twist, mut base) = (Vector6::zeros(), Vector6::zeros());
        let joints = motion.jacobian.column_iter().zip(motion.velocity);
        for (joint, (column, &velocity)) in joints.take(body.joints).enumerate() {
            twist += column * velocity;
            if joint < base_joints {
                base = twist;
            }
        }
        let (linear, angular) = (twist.fixed_rows::<3>(0), twist.fixed_rows::<3>(3));
        let middle = (body.capsule.start() + body.capsule.end()) * 0.5;
        let arm = middle - motion.origin;
        let change = motion.change.map_or(f64::INFINITY, |change| {
            let joints = motion.jacobian.column_iter().zip(change).take(body.joints);
            let of_joint = |(column, change): (Column<'_>, &f64)| {
                let (linear, angular) = (column.fixed_rows::<3>(0), column.fixed_rows::<3>(3));
                let of_middle = linear + angular.cross(&arm);
                change * (of_middle.norm() + angular.norm() * body.capsule.reach())
            };
            joints.map(of_joint).sum()
        });
        let lever = arm.norm() + body.capsule.reach();
        Self { fastest: linear.norm() + angular.norm() * lever, change, twist, base }
    }

    /// How fast a point of the body, `arm` from o, moves against the `normal`, and the part of it that is the
    /// base's \[m/s\].
    pub(super) fn approach(&self, normal: &Vector3<f64>, arm: &Vector3<f64>) -> (f64, f64) {
        let moment = arm.cross(normal);
        let along = |twist: &Vector6<f64>| {
            -twist.fixed_rows::<3>(0).dot(normal) - twist.fixed_rows::<3>(3).dot(&moment)
        };
        (along(&self.twist), along(&self.base))
    }
}
