//! Fast bounds of the changes of speed of the robot's points within a tick.

use crate::approach::bodies::RobotBody;
use crate::approach::joint_motion::JointMotion;

/// Prefix sums over the joints of the largest change of velocity within a tick. They are weighted
/// by the linear and the angular part of each joint's column of the Jacobian.
#[derive(Debug, Clone)]
pub(super) struct JointChanges {
    /// \[m/s, rad/s\], indexed by the number of joints. Empty if the changes are not known.
    sums: Vec<[f64; 2]>,
}

impl JointChanges {
    /// Creates empty sums for a robot with this number of joints.
    pub(super) fn new(joints: usize) -> Self {
        Self { sums: Vec::with_capacity(joints + 1) }
    }

    /// Computes the sums for the motion of a tick. Allocates nothing.
    pub(super) fn update(&mut self, motion: &JointMotion<'_>) {
        self.sums.clear();
        let Some(change) = motion.change else { return };
        let mut sum = [0.0; 2];
        self.sums.push(sum);
        for ([linear, angular], change) in motion.columns(change.len()).zip(change) {
            sum[0] += change * linear.norm();
            sum[1] += change * angular.norm();
            self.sums.push(sum);
        }
    }

    /// Returns an upper bound of the change of speed of every point of the body \[m/s\]. It adds
    /// the joints' contributions as if all had one direction, and bounds each lever arm by the way
    /// over o.
    pub(super) fn most(&self, motion: &JointMotion<'_>, body: &RobotBody) -> f64 {
        let arm = (body.capsule.middle() - motion.origin).norm() + body.capsule.reach();
        self.sums.get(body.joints).map_or(f64::INFINITY, |[linear, angular]| linear + angular * arm)
    }
}
