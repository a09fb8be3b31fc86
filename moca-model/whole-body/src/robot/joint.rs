//! Joints: what moves a robot.

use super::frame::FrameId;

/// A joint of one [`Model`](crate::Model); see [`Model::joint_id`](crate::Model::joint_id).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct JointId {
    pub(crate) model: u64,
    pub(crate) index: usize,
}

/// A joint that moves by itself: entries of q and q̇ are its own.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Joint {
    /// Its name in the URDF; `base_x`, `base_y` and `base_yaw` for a planar base, `floating_base` for a
    /// floating one.
    pub name: String,
    /// How it moves.
    pub kind: JointKind,
    /// The link that it carries.
    pub child: FrameId,
    /// Where its entries of q begin.
    pub position_index: usize,
    /// Where its entries of q̇ begin.
    pub velocity_index: usize,
}

/// How a joint moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointKind {
    /// Along its axis \[m\].
    Prismatic,
    /// About its axis, between limits \[rad\].
    Revolute,
    /// About its axis without position limits; a plain angle, not wrapped \[rad\].
    Continuous,
    /// Freely in space: seven entries of q, six of q̇; see [`Base::Floating`](crate::Base::Floating).
    Floating,
}

impl JointKind {
    /// How many entries of q it has.
    pub fn positions(self) -> usize {
        if self == Self::Floating { 7 } else { 1 }
    }

    /// How many entries of q̇ it has.
    pub fn velocities(self) -> usize {
        if self == Self::Floating { 6 } else { 1 }
    }
}

/// A joint that follows another one: its position is multiplier · q + offset.
///
/// It is no degree of freedom: its share of Jacobians, forces and inertias is added to that of the
/// joint that it follows. Its limits of position, velocity, acceleration and jerk are kept: where they are narrower,
/// they are those of the joint that it follows, with a [`Warning`](crate::robot::Warning).
#[derive(Debug, Clone, PartialEq)]
pub struct MimicJoint {
    /// Its name in the URDF.
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
