//! By how much points of the robot may get faster within a tick, quickly.

use crate::approach::bodies::RobotBody;
use crate::approach::joint_motion::JointMotion;

/// Of the joints up to each, the sums of what their velocities may change within a tick, times how fast each
/// moves o, and times how fast it turns.
#[derive(Debug, Clone)]
pub(super) struct JointChanges {
    /// \[m/s, rad/s\], by how many joints, from none; empty where the changes are not known.
    sums: Vec<[f64; 2]>,
}

impl JointChanges {
    /// For a robot with so many joints.
    pub(super) fn new(joints: usize) -> Self {
        Self { sums: Vec::with_capacity(joints + 1) }
    }

    /// Takes the motion of a tick. Allocates nothing.
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

    /// No point of the body gets faster by more \[m/s\]: all joints one way, and none nearer to the body than to o
    /// and from there to the body.
    pub(super) fn most(&self, motion: &JointMotion<'_>, body: &RobotBody) -> f64 {
        let arm = (body.capsule.middle() - motion.origin).norm() + body.capsule.reach();
        self.sums.get(body.joints).map_or(f64::INFINITY, |[linear, angular]| linear + angular * arm)
    }
}
