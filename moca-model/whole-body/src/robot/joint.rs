//! Joints: what moves a robot.

use super::frame::FrameId;

/// A joint of one [`Model`](crate::Model); see [`Model::joint_id`](crate::Model::joint_id).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct JointId {
    pub(crate) model: u64,
    pub(crate) index: usize,
}

/// A joint with its own entries of q and q̇.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Joint {
    /// Name in the URDF; `base_x`, `base_y` and `base_yaw` for a planar base, `floating_base` for a
    /// floating one.
    pub name: String,
    /// Kind of motion.
    pub kind: JointKind,
    /// The link that it carries.
    pub child: FrameId,
    /// The first of its entries of q.
    pub position_index: usize,
    /// The first of its entries of q̇.
    pub velocity_index: usize,
}

/// The kind of motion of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointKind {
    /// Translation along its axis \[m\].
    Prismatic,
    /// Rotation about its axis between limits \[rad\].
    Revolute,
    /// Rotation about its axis without position limits, as a plain angle that is not wrapped \[rad\].
    Continuous,
    /// Free motion in space with seven entries of q and six of q̇; see [`Base::Floating`](crate::Base::Floating).
    Floating,
}

impl JointKind {
    /// The number of entries of q.
    pub fn positions(self) -> usize {
        if self == Self::Floating { 7 } else { 1 }
    }

    /// The number of entries of q̇.
    pub fn velocities(self) -> usize {
        if self == Self::Floating { 6 } else { 1 }
    }
}

/// A joint that follows another one: its position is multiplier · q + offset.
///
/// It is not a degree of freedom. Its share of Jacobians, forces and inertias is added to that of the joint that it
/// follows. Its limits of position, velocity, acceleration and jerk are kept. Narrower ones become limits of the joint
/// that it follows, with a [`Warning`](crate::robot::Warning).
#[derive(Debug, Clone, PartialEq)]
pub struct MimicJoint {
    /// Name in the URDF.
    pub name: String,
    /// The joint that it follows.
    pub follows: JointId,
    /// \[1, rad/m or m/rad\]
    pub multiplier: f64,
    /// \[rad or m\]
    pub offset: f64,
    /// The link that it carries.
    pub child: FrameId,
}
