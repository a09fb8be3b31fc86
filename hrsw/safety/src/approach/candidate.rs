//! Points that may get a row.

use nalgebra::Vector3;

use crate::approach::joint_motion::JointMotion;

/// Identity of a candidate: the indices of both bodies, and the end of the first body's capsule.
/// The end is none for the nearest point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct PointId {
    pub(super) robot: usize,
    pub(super) other: usize,
    pub(super) end: Option<usize>,
}

/// A point of a body of the robot that approaches another body: the nearest point, or an end of its
/// capsule.
#[derive(Debug, Clone, Copy)]
pub(super) struct Candidate {
    pub(super) id: PointId,
    /// Unit vector from the other body to this one.
    pub(super) normal: Vector3<f64>,
    /// Point on the axis of the robot's capsule, moved by the first `joints` joints.
    pub(super) point: Vector3<f64>,
    pub(super) joints: usize,
    /// Point and number of joints of the other body, if that is the robot's as well.
    pub(super) opposite: Option<(Vector3<f64>, usize)>,
    /// Distance minus the protective distance of a robot at rest \[m\].
    pub(super) room: f64,
    /// Largest allowed speed of approach \[m/s\].
    pub(super) limit: f64,
    /// `limit` minus the speed of approach at the last commanded velocity \[m/s\].
    pub(super) headroom: f64,
    pub(super) contact: bool,
}

impl Candidate {
    /// Subtracts the gradient of the distance with respect to the joints from the row.
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
