//! The capsules around the person's joints, independent of those of the controller.

use simulated_people::Joints;
use vision_models::Body25;
use vision_models::Body25::{
    LeftAnkle, LeftElbow, LeftHip, LeftKnee, LeftShoulder, LeftWrist, MidHip, Neck, Nose,
    RightAnkle, RightElbow, RightHip, RightKnee, RightShoulder, RightWrist,
};

use super::rod::Rod;

/// Capsules: start joint, end joint, extension, radius \[m\], and whether the part may touch the workpiece.
const PARTS: [(Body25, Body25, f64, f64, bool); 12] = [
    (MidHip, Neck, 0.0, 0.15, true),
    (Neck, Nose, 0.0, 0.13, false),
    (RightShoulder, LeftShoulder, 0.0, 0.08, true),
    (RightHip, LeftHip, 0.0, 0.12, true),
    (RightHip, RightKnee, 0.0, 0.09, true),
    (RightKnee, RightAnkle, 0.05, 0.08, true),
    (LeftHip, LeftKnee, 0.0, 0.09, true),
    (LeftKnee, LeftAnkle, 0.05, 0.08, true),
    (RightShoulder, RightElbow, 0.0, 0.06, true),
    (RightElbow, RightWrist, 0.15, 0.06, true),
    (LeftShoulder, LeftElbow, 0.0, 0.06, true),
    (LeftElbow, LeftWrist, 0.15, 0.06, true),
];

/// The number of capsules of a body.
pub(super) const PART_COUNT: usize = PARTS.len();

/// Returns true if a part may touch a robot that it works with, which excludes the head.
pub(super) fn may_touch(part: usize) -> bool {
    PARTS[part].4
}

/// Returns true if a part belongs to an arm.
pub(crate) fn is_arm(part: usize) -> bool {
    matches!(PARTS[part].1, RightElbow | RightWrist | LeftElbow | LeftWrist)
}

/// The capsules around the joints.
pub(crate) fn capsules(joints: &Joints) -> [Rod; PART_COUNT] {
    PARTS.map(|(from, to, beyond, radius, _)| {
        let (from, to) = (joints[from.index()].coords, joints[to.index()].coords);
        let along = (to - from).try_normalize(1e-9).unwrap_or_default();
        Rod { ends: [from, to + along * beyond], radius }
    })
}

/// The joints at the ends of the capsules.
pub(crate) fn joints() -> impl Iterator<Item = Body25> {
    PARTS.into_iter().flat_map(|(from, to, ..)| [from, to])
}
