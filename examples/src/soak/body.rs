//! The person's body: joints, and the capsules around them.

use nalgebra::{Point3, Vector3};
use vision_models::Body25;
use vision_models::Body25::{
    LeftAnkle, LeftElbow, LeftHip, LeftKnee, LeftShoulder, LeftWrist, MidHip, Neck, Nose,
    RightAnkle, RightElbow, RightHip, RightKnee, RightShoulder, RightWrist,
};

use super::distance::Rod;

/// The joints of `BODY_25` in the world \[m\].
pub(super) type Joints = [Vector3<f64>; Body25::COUNT];

/// From joint to joint and on by a length, with a radius \[m\]; whether it is of an arm.
const PARTS: [(Body25, Body25, f64, f64, bool); 12] = [
    (MidHip, Neck, 0.0, 0.15, false),
    (Neck, Nose, 0.0, 0.13, false),
    (RightShoulder, LeftShoulder, 0.0, 0.08, false),
    (RightHip, LeftHip, 0.0, 0.12, false),
    (RightHip, RightKnee, 0.0, 0.09, false),
    (RightKnee, RightAnkle, 0.05, 0.08, false),
    (LeftHip, LeftKnee, 0.0, 0.09, false),
    (LeftKnee, LeftAnkle, 0.05, 0.08, false),
    (RightShoulder, RightElbow, 0.0, 0.06, true),
    (RightElbow, RightWrist, 0.15, 0.06, true),
    (LeftShoulder, LeftElbow, 0.0, 0.06, true),
    (LeftElbow, LeftWrist, 0.15, 0.06, true),
];

/// How many capsules a body has.
pub(super) const PART_COUNT: usize = PARTS.len();

/// Whether a part is of an arm, which works on what the robot holds.
pub(super) fn is_arm(part: usize) -> bool {
    PARTS[part].4
}

/// The capsules around the joints.
pub(super) fn capsules(joints: &Joints) -> [Rod; PART_COUNT] {
    PARTS.map(|(from, to, beyond, radius, _)| {
        let (from, to) = (joints[from.index()], joints[to.index()]);
        let along = (to - from).try_normalize(1e-9).unwrap_or_default();
        Rod { ends: [from, to + along * beyond], radius }
    })
}

/// A standing body of this stature (m) in the axes of the person: x forwards, y to the left. The
/// hands are at `hands`, left and right, as fractions of stature.
pub(super) fn standing(stature: f64, hands: &[Vector3<f64>; 2]) -> Joints {
    let mut joints = [Vector3::new(0.0, 0.0, 0.93); Body25::COUNT];
    let mut set = |joint: Body25, x: f64, y: f64, z: f64| {
        joints[joint.index()] = Vector3::new(x, y, z);
    };
    set(Nose, 0.06, 0.0, 0.91);
    set(Neck, 0.0, 0.0, 0.818);
    set(MidHip, 0.0, 0.0, 0.53);
    for (side, hand, [shoulder, elbow, wrist, hip, knee, ankle]) in [
        (1.0, hands[0], [LeftShoulder, LeftElbow, LeftWrist, LeftHip, LeftKnee, LeftAnkle]),
        (-1.0, hands[1], [RightShoulder, RightElbow, RightWrist, RightHip, RightKnee, RightAnkle]),
    ] {
        set(shoulder, 0.0, side * 0.118, 0.818);
        set(elbow, 0.5 * hand.x - 0.03, side * 0.15, 0.5 * (0.818 + hand.z) - 0.05);
        set(wrist, hand.x, hand.y, hand.z);
        set(hip, 0.0, side * 0.055, 0.53);
        set(knee, 0.01, side * 0.06, 0.285);
        set(ankle, 0.0, side * 0.07, 0.039);
    }
    joints.map(|joint| joint * stature)
}

/// As points, for the camera.
pub(super) fn points(joints: &Joints) -> [Point3<f64>; Body25::COUNT] {
    joints.map(Point3::from)
}
