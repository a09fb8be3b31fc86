//! The two models of 25 joints.

use nalgebra::{Point2, center};

use crate::body::{
    body_25::Body25,
    image_body::{ImageBody, ImageKeypoint},
    joint_layout::JointLayout,
};

/// Largest distance of neck and mid hip from the midpoints of shoulders and hips, as a share of the
/// body's size.
const NEAR_THE_MIDDLE: f64 = 0.04;
/// The limbs in the right order are shorter than this share of the limbs in the wrong order.
const SHORTER: f64 = 0.9;
/// Largest distance of the top of the head from the nose, as a share of the body's size.
const HEAD: f64 = 0.4;
/// Indices of nose and top of the head in BODY_25B.
const NOSE: usize = 0;
const TOP: usize = 18;
/// Smallest number of limbs for a comparison.
const FEW: usize = 4;

/// Pairs of joints that are close to each other on a body.
const LIMBS: [[Body25; 2]; 16] = {
    use Body25::{
        LeftAnkle, LeftBigToe, LeftEar, LeftElbow, LeftEye, LeftHip, LeftKnee, LeftShoulder,
        LeftWrist, Nose, RightAnkle, RightBigToe, RightEar, RightElbow, RightEye, RightHip,
        RightKnee, RightShoulder, RightWrist,
    };
    [
        [Nose, LeftEye],
        [Nose, RightEye],
        [LeftEye, LeftEar],
        [RightEye, RightEar],
        [LeftShoulder, RightShoulder],
        [LeftShoulder, LeftElbow],
        [RightShoulder, RightElbow],
        [LeftElbow, LeftWrist],
        [RightElbow, RightWrist],
        [LeftHip, RightHip],
        [LeftHip, LeftKnee],
        [RightHip, RightKnee],
        [LeftKnee, LeftAnkle],
        [RightKnee, RightAnkle],
        [LeftAnkle, LeftBigToe],
        [RightAnkle, RightBigToe],
    ]
};

/// Returns a person of 25 joints in the order of BODY_25 or BODY_25B.
///
/// BODY_25 has the neck between the shoulders and mid hip between the hips. BODY_25B has other
/// joints in those places. The order is BODY_25B if neck or mid hip lie elsewhere or are missing.
/// In addition, the top of the head must be near the nose, and the limbs must be shorter in that
/// order.
pub(super) fn body_of_25(keypoints: &[Option<ImageKeypoint>; Body25::COUNT]) -> ImageBody {
    let plain = ImageBody::new(*keypoints);
    let Some(size) = plain.size() else { return plain };
    let has_head = match [keypoints[NOSE], keypoints[TOP]] {
        [Some(nose), Some(top)] => (top.position - nose.position).norm() < HEAD * size,
        _ => true,
    };
    let is_in_place = off_the_middle(&plain).is_some_and(|off| off < NEAR_THE_MIDDLE * size);
    if is_in_place || !has_head {
        return plain;
    }
    let other = JointLayout::Body25B.body(keypoints);
    match (mean_limb(&plain), mean_limb(&other)) {
        (Some(own), Some(others)) if others < SHORTER * own => other,
        _ => plain,
    }
}

fn place(body: &ImageBody, joint: Body25) -> Option<Point2<f64>> {
    body.get(joint).map(|keypoint| keypoint.position)
}

/// Returns the larger distance of neck and mid hip from the midpoints of shoulders and hips
/// (pixels). `None` if neither is known.
fn off_the_middle(body: &ImageBody) -> Option<f64> {
    let off = |middle, one, other| {
        let half_way = center(&place(body, one)?, &place(body, other)?);
        Some((place(body, middle)? - half_way).norm())
    };
    let neck = off(Body25::Neck, Body25::LeftShoulder, Body25::RightShoulder);
    let hips = off(Body25::MidHip, Body25::LeftHip, Body25::RightHip);
    neck.into_iter().chain(hips).reduce(f64::max)
}

/// Returns the mean length of the limbs that were seen (pixels).
fn mean_limb(body: &ImageBody) -> Option<f64> {
    let length = |[from, to]: [Body25; 2]| Some((place(body, to)? - place(body, from)?).norm());
    let (count, sum) = LIMBS
        .into_iter()
        .filter_map(length)
        .fold((0_usize, 0.0), |(count, sum), length| (count + 1, sum + length));
    (count >= FEW).then(|| sum / count as f64)
}
