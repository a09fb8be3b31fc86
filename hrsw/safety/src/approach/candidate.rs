//! A point that may get a row.

use nalgebra::Vector3;

use crate::approach::joint_motion::JointMotion;

/// Which point a candidate is: the indices of both bodies, and the end of the first one's capsule, none for the
/// nearest point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct PointId {
    pub(super) robot: usize,
    pub(super) other: usize,
    pub(super) end: Option<usize>,
}

/// A point of a body of the robot that comes nearer to another body: the nearest one, or an end of its capsule.
#[derive(Debug, Clone, Copy)]
pub(super) struct Candidate {
    pub(super) id: PointId,
    /// From the other body to this one, of length 1.
    pub(super) normal: Vector3<f64>,
    /// On the axis of the robot's capsule, moved by the first of its joints.
    pub(super) point: Vector3<f64>,
    pub(super) joints: usize,
    /// The same of the other, for one of the robot's.
    pub(super) opposite: Option<(Vector3<f64>, usize)>,
    /// How much farther apart the two are than a robot at rest should be \[m\].
    pub(super) room: f64,
    /// How fast it may come nearer \[m/s\].
    pub(super) limit: f64,
    /// How much faster it may come nearer than at the last commanded velocity \[m/s\].
    pub(super) headroom: f64,
    pub(super) contact: bool,
}

impl Candidate {
    /// How fast the two come nearer, for each joint.
    pub(super) fn write(&self, motion: &JointMotion<'_>, row: &mut [f64]) {
        let mut add = |joints: usize, point: &Vector3<f64>, normal: &Vector3<f64>| {
            let moment = (point - motion.origin).cross(normal);
            for (out, [linear, angular]) in row.iter_mut().zip(motion.columns(joints)) {
                *out -= linear.dot(normal) + angular.dot(&moment);
            }
        };
        add(self.joints, &self.point, &self.normal);
        if let Some((point, joints)) = &self.opposite {
            add(*joints, point, &-self.normal);
        }
    }
}
