//! Joints at the midpoints of others.

use super::body_25::Body25::{self, LeftHip, LeftShoulder, MidHip, Neck, RightHip, RightShoulder};

/// Joint at the midpoint of two others.
///
/// ```
/// use vision_models::{Body25, JointLayout, Middle};
///
/// let derived: Vec<_> = JointLayout::Coco18.derived().collect();
/// assert_eq!(derived, [Middle::HIPS]);
/// assert_eq!(Middle::HIPS.sides, [Body25::LeftHip, Body25::RightHip]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Middle {
    /// Joint at the midpoint.
    pub joint: Body25,
    /// Joints on the left and on the right of it.
    pub sides: [Body25; 2],
}

impl Middle {
    /// The neck, between the shoulders.
    pub const SHOULDERS: Self = Self { joint: Neck, sides: [LeftShoulder, RightShoulder] };
    /// The mid hip, between the hips.
    pub const HIPS: Self = Self { joint: MidHip, sides: [LeftHip, RightHip] };
    /// The neck and the mid hip.
    pub const ALL: [Self; 2] = [Self::SHOULDERS, Self::HIPS];
}
