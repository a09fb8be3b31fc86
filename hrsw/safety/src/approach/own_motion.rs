//! Relative motion of two bodies of the robot.

use nalgebra::Vector3;

use crate::approach::bodies::RobotBody;
use crate::approach::joint_motion::JointMotion;

/// Upper bounds of the speed at which two bodies of one robot approach each other \[m/s\].
///
/// Joints that carry both bodies move them as one. Only joints that move one body and not the other
/// count.
#[derive(Debug, Clone, Copy)]
pub(super) struct OwnMotion {
    /// Speed at the last commanded velocity.
    pub(super) fastest: f64,
    /// Largest increase of the speed within this tick.
    pub(super) change: f64,
}

impl OwnMotion {
    /// Bounds the motion of a body against another one that the first `shared` of its joints move.
    pub(super) fn of_pair(motion: &JointMotion<'_>, moved: &RobotBody, shared: usize) -> Self {
        let (arm, reach) = (moved.capsule.middle() - motion.origin, moved.capsule.reach());
        let joints = || motion.columns(moved.joints).skip(shared);
        let speed = |[linear, angular]: [Vector3<f64>; 2]| {
            (linear + angular.cross(&arm)).norm() + angular.norm() * reach
        };
        let mut twist = [Vector3::zeros(); 2];
        for ([linear, angular], rate) in joints().zip(motion.velocity.iter().skip(shared)) {
            twist[0] += linear * *rate;
            twist[1] += angular * *rate;
        }
        let change = motion.change.map_or(f64::INFINITY, |change| {
            let changes = joints().zip(change.iter().skip(shared));
            changes.map(|(of_joint, change)| change * speed(of_joint)).sum()
        });
        Self { fastest: speed(twist), change }
    }

    /// Bounds the motion of every pair: that of the point farthest from o, with the effects of all
    /// joints added that do not carry all bodies.
    pub(super) fn of_all(motion: &JointMotion<'_>, robot: &[RobotBody]) -> Self {
        let shared = robot.iter().map(|body| body.joints).min().unwrap_or_default();
        let moved = || robot.iter().filter(|body| body.joints > shared);
        let farthest = |body: &RobotBody| {
            (body.capsule.middle() - motion.origin).norm() + body.capsule.reach()
        };
        let farthest = moved().map(farthest).fold(0.0, f64::max);
        let joints = moved().map(|body| body.joints).max().unwrap_or(shared);
        let most = |rates: &[f64]| -> f64 {
            let of_joint = |([linear, angular], rate): ([Vector3<f64>; 2], &f64)| {
                rate.abs() * (linear.norm() + angular.norm() * farthest)
            };
            motion.columns(joints).zip(rates).skip(shared).map(of_joint).sum()
        };
        Self { fastest: most(motion.velocity), change: motion.change.map_or(f64::INFINITY, most) }
    }
}
