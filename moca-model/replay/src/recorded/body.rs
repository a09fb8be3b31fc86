//! The person as capsules between points of the body.
//!
//! Thicknesses are fractions of stature, chosen for a clear picture. No score depends on them.

use ergo_map::{JointAngles, Landmarks, Person, Side, Skeleton};
use nalgebra::Vector3;
use vision_models::{Body, Body25};

/// Number of points of a body.
pub(crate) const POINT_COUNT: usize = BODY_POINTS.len();

/// Names of the points; left before right.
pub(crate) const BODY_POINTS: [&str; 21] = [
    "neck",
    "pelvis",
    "chest",
    "head",
    "nose",
    "left shoulder",
    "right shoulder",
    "left elbow",
    "right elbow",
    "left wrist",
    "right wrist",
    "left hand",
    "right hand",
    "left hip",
    "right hip",
    "left knee",
    "right knee",
    "left ankle",
    "right ankle",
    "left toe",
    "right toe",
];

/// Positions of [`BODY_POINTS`] \[m\]; `None` where a point is unknown.
pub(super) type Points = [Option<Vector3<f64>>; POINT_COUNT];

/// Part of the body that has a sub-score of REBA.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BodyPart {
    /// Neck and head.
    Neck,
    /// Trunk, pelvis and shoulders.
    Trunk,
    /// Both legs.
    Legs,
    /// Upper arm of a side.
    UpperArm(Side),
    /// Lower arm of a side.
    LowerArm(Side),
    /// Wrist and hand of a side.
    Wrist(Side),
}

/// Capsule between two points whose radius changes linearly.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limb {
    /// Indices of two points.
    pub(crate) ends: [usize; 2],
    /// Radii at the two points, as fractions of stature.
    pub(crate) radii: [f64; 2],
    /// Part of the body.
    pub(crate) part: BodyPart,
}

const fn limb(ends: [usize; 2], radii: [f64; 2], part: BodyPart) -> Limb {
    Limb { ends, radii, part }
}

/// Capsules of a body.
pub(crate) const LIMBS: [Limb; 22] = {
    use BodyPart::{Legs, LowerArm, Neck, Trunk, UpperArm, Wrist};
    use Side::{Left, Right};
    [
        limb([0, 3], [0.032, 0.034], Neck),
        limb([3, 3], [0.052, 0.052], Neck),
        limb([3, 4], [0.030, 0.012], Neck),
        limb([13, 14], [0.053, 0.053], Trunk),
        limb([1, 2], [0.060, 0.062], Trunk),
        limb([13, 5], [0.050, 0.036], Trunk),
        limb([14, 6], [0.050, 0.036], Trunk),
        limb([5, 6], [0.034, 0.034], Trunk),
        limb([13, 15], [0.049, 0.036], Legs),
        limb([14, 16], [0.049, 0.036], Legs),
        limb([15, 17], [0.035, 0.024], Legs),
        limb([16, 18], [0.035, 0.024], Legs),
        limb([17, 19], [0.024, 0.016], Legs),
        limb([18, 20], [0.024, 0.016], Legs),
        limb([5, 7], [0.032, 0.025], UpperArm(Left)),
        limb([6, 8], [0.032, 0.025], UpperArm(Right)),
        limb([7, 9], [0.025, 0.018], LowerArm(Left)),
        limb([8, 10], [0.025, 0.018], LowerArm(Right)),
        limb([9, 11], [0.018, 0.020], Wrist(Left)),
        limb([10, 12], [0.018, 0.020], Wrist(Right)),
        limb([11, 11], [0.024, 0.024], Wrist(Left)),
        limb([12, 12], [0.024, 0.024], Wrist(Right)),
    ]
};

/// Position of the chest between hips (0) and neck (1): there the trunk becomes as wide as the shoulders.
const CHEST: f64 = 0.72;
/// Distance from the wrist to the grip, as a fraction of stature.
const GRIP: f64 = 0.055;

/// Returns the points of a person whose joints were seen; `stature` in m.
pub(super) fn seen(body: &Body, stature: f64) -> Points {
    use Body25::{
        LeftAnkle, LeftBigToe, LeftEar, LeftElbow, LeftHip, LeftKnee, LeftShoulder, LeftWrist,
        MidHip, Neck, Nose, RightAnkle, RightBigToe, RightEar, RightElbow, RightHip, RightKnee,
        RightShoulder, RightWrist,
    };
    let at = |joint: Body25| body.get(joint).map(|keypoint| keypoint.position.coords);
    let hand = |elbow: Body25, wrist: Body25| {
        let (elbow, wrist) = (at(elbow)?, at(wrist)?);
        Some(wrist + (wrist - elbow).try_normalize(1e-9)? * (GRIP * stature))
    };
    let (neck, pelvis) = (at(Neck), at(MidHip));
    let chest = neck.zip(pelvis).map(|(neck, pelvis)| pelvis + (neck - pelvis) * CHEST);
    let ears = at(LeftEar).zip(at(RightEar)).map(|(left, right)| (left + right) * 0.5);
    [
        neck,
        pelvis,
        chest,
        ears.or(at(LeftEar)).or(at(RightEar)),
        at(Nose),
        at(LeftShoulder),
        at(RightShoulder),
        at(LeftElbow),
        at(RightElbow),
        at(LeftWrist),
        at(RightWrist),
        hand(LeftElbow, LeftWrist),
        hand(RightElbow, RightWrist),
        at(LeftHip),
        at(RightHip),
        at(LeftKnee),
        at(RightKnee),
        at(LeftAnkle),
        at(RightAnkle),
        at(LeftBigToe),
        at(RightBigToe),
    ]
}

/// Returns the points of a person in a posture, in their own frame. The other arm, which the model does not have, hangs
/// down.
///
/// # Errors
/// Angles that are not finite.
pub(super) fn posed(
    person: &Person,
    side: Side,
    angles: &JointAngles,
) -> Result<Points, ergo_map::Error> {
    let at = Skeleton::new(person, side).landmarks(angles)?;
    let stature = person.stature();
    let beside = |point: Vector3<f64>, by: f64| Some(point + Vector3::y() * (by * stature));
    let both = |point: Vector3<f64>, by: f64| [beside(point, by), beside(point, -by)];
    let spine = (at.neck - at.lumbar).normalize();
    // Forwards, perpendicular to the trunk in the sagittal plane.
    let ahead = Vector3::new(spine.z, 0.0, -spine.x).normalize() * stature;
    let head = at.eyes - ahead * 0.05;
    let [left_hip, right_hip] = both(at.hip, 0.055);
    let [left_knee, right_knee] = both(at.knee, 0.058);
    let [left_ankle, right_ankle] = both(at.ankle, 0.06);
    let toe = at.ankle + Vector3::new(0.10, 0.0, -0.022) * stature;
    let [left_toe, right_toe] = both(toe, 0.066);
    let arm = working_arm(&at);
    let rest = hanging_arm(person, at.other_shoulder);
    let (left, right) = match side {
        Side::Left => (arm, rest),
        Side::Right => (rest, arm),
    };
    Ok([
        Some(at.neck),
        Some(at.hip),
        Some(at.hip + (at.neck - at.hip) * CHEST),
        Some(head),
        Some(head + ahead * 0.065 - spine * (0.012 * stature)),
        left[0],
        right[0],
        left[1],
        right[1],
        left[2],
        right[2],
        left[3],
        right[3],
        left_hip,
        right_hip,
        left_knee,
        right_knee,
        left_ankle,
        right_ankle,
        left_toe,
        right_toe,
    ])
}

fn working_arm(at: &Landmarks) -> [Option<Vector3<f64>>; 4] {
    [Some(at.shoulder), Some(at.elbow), Some(at.wrist), Some(at.hand)]
}

fn hanging_arm(person: &Person, shoulder: Vector3<f64>) -> [Option<Vector3<f64>>; 4] {
    let segments = person.segments();
    let down = |from: Vector3<f64>, by: Option<f64>| from - Vector3::z() * by.unwrap_or_default();
    let elbow = down(shoulder, segments.upper_arm);
    let wrist = down(elbow, segments.forearm);
    [Some(shoulder), Some(elbow), Some(wrist), Some(down(wrist, segments.grip))]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hand_of_posture_matches_the_skeleton() {
        let (person, angles) = (Person::average(), JointAngles::default());
        for (side, index) in [(Side::Left, 11), (Side::Right, 12)] {
            let points = posed(&person, side, &angles).unwrap();
            let hand = Skeleton::new(&person, side).landmarks(&angles).unwrap().hand;
            assert_eq!(points[index], Some(hand));
            assert_eq!(BODY_POINTS[index].starts_with("left"), side == Side::Left);
        }
    }

    #[test]
    fn left_is_left_of_right() {
        let points = posed(&Person::average(), Side::Right, &JointAngles::default()).unwrap();
        for (index, name) in BODY_POINTS.iter().enumerate() {
            if name.starts_with("left ") {
                let (left, right) = (points[index].unwrap(), points[index + 1].unwrap());
                assert!(left.y > right.y, "{name}");
            }
        }
    }
}
