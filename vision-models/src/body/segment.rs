//! The segments of the body that keep their length in every posture.

use super::body_25::Body25;

/// A segment of the body. Segments with a left and a right side count as one.
///
/// ```
/// use vision_models::BodySegment;
///
/// assert_eq!(BodySegment::Thigh.fraction(), 0.245);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BodySegment {
    /// Hip to knee.
    Thigh,
    /// Knee to ankle.
    Shank,
    /// Mid hip to neck.
    Trunk,
    /// Shoulder to elbow.
    UpperArm,
    /// Elbow to wrist.
    Forearm,
    /// Shoulder to shoulder.
    Shoulders,
}

/// Each segment between two joints, the joint nearer to the trunk first.
pub(super) const ENDS: [(BodySegment, Body25, Body25); 10] = [
    (BodySegment::Trunk, Body25::MidHip, Body25::Neck),
    (BodySegment::Shoulders, Body25::LeftShoulder, Body25::RightShoulder),
    (BodySegment::Thigh, Body25::LeftHip, Body25::LeftKnee),
    (BodySegment::Thigh, Body25::RightHip, Body25::RightKnee),
    (BodySegment::Shank, Body25::LeftKnee, Body25::LeftAnkle),
    (BodySegment::Shank, Body25::RightKnee, Body25::RightAnkle),
    (BodySegment::UpperArm, Body25::LeftShoulder, Body25::LeftElbow),
    (BodySegment::UpperArm, Body25::RightShoulder, Body25::RightElbow),
    (BodySegment::Forearm, Body25::LeftElbow, Body25::LeftWrist),
    (BodySegment::Forearm, Body25::RightElbow, Body25::RightWrist),
];

impl BodySegment {
    /// The number of segments.
    pub const COUNT: usize = 6;

    /// Returns the length as a fraction of stature (Drillis & Contini 1966; for the shoulder joints
    /// ANSUR II 2012).
    pub fn fraction(self) -> f64 {
        match self {
            Self::Thigh => 0.245,
            Self::Shank => 0.246,
            Self::Trunk => 0.288,
            Self::UpperArm => 0.186,
            Self::Forearm => 0.146,
            Self::Shoulders => 0.230,
        }
    }

    pub(super) fn index(self) -> usize {
        self as usize
    }
}
