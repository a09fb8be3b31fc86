//! The capsules of the person.

use nalgebra::{Point3, Vector3};
use vision_models::Body25;

use super::shape::Capsule;
use crate::simulation::Joints;

/// Colours of skin, shirt, trousers and shoes.
const SKIN: [f64; 3] = [0.80, 0.60, 0.50];
const SHIRT: [f64; 3] = [0.25, 0.35, 0.60];
const TROUSERS: [f64; 3] = [0.20, 0.20, 0.25];
const SHOES: [f64; 3] = [0.10, 0.09, 0.08];

/// A segment between two joints; the radius as a fraction of stature, which is that of an adult in
/// working clothes.
const SEGMENTS: [(Body25, Body25, f64, [f64; 3]); 14] = {
    use Body25::{
        LeftAnkle, LeftBigToe, LeftElbow, LeftHip, LeftKnee, LeftShoulder, LeftWrist, RightAnkle,
        RightBigToe, RightElbow, RightHip, RightKnee, RightShoulder, RightWrist,
    };
    [
        (LeftHip, RightHip, 0.056, TROUSERS),
        (LeftShoulder, RightShoulder, 0.037, SHIRT),
        (LeftShoulder, LeftElbow, 0.026, SHIRT),
        (RightShoulder, RightElbow, 0.026, SHIRT),
        (LeftElbow, LeftWrist, 0.019, SKIN),
        (RightElbow, RightWrist, 0.019, SKIN),
        (LeftHip, LeftKnee, 0.042, TROUSERS),
        (RightHip, RightKnee, 0.042, TROUSERS),
        (LeftKnee, LeftAnkle, 0.024, TROUSERS),
        (RightKnee, RightAnkle, 0.024, TROUSERS),
        (LeftAnkle, LeftBigToe, 0.022, SHOES),
        (RightAnkle, RightBigToe, 0.022, SHOES),
        (LeftHip, LeftShoulder, 0.050, SHIRT),
        (RightHip, RightShoulder, 0.050, SHIRT),
    ]
};

/// The capsules of a person with these joints (world, m), in the world.
pub(super) fn capsules(joints: &Joints, stature: f64) -> impl Iterator<Item = Capsule> + '_ {
    let at = |joint: Body25| joints[joint.index()];
    let limbs = SEGMENTS.into_iter().map(move |(from, to, radius, colour)| Capsule {
        ends: [at(from), at(to)],
        radius: radius * stature,
        colour,
    });
    let (hips, neck) = (at(Body25::MidHip), at(Body25::Neck));
    let head = nalgebra::center(&at(Body25::LeftEar), &at(Body25::RightEar));
    // Shoulders are at the trunk's top: the chest ends below them.
    let chest = hips + (neck - hips) * 0.75;
    let hand = |elbow: Body25, wrist: Body25| {
        let along = (at(wrist) - at(elbow)).try_normalize(1e-9).unwrap_or(Vector3::zeros());
        capsule(at(wrist), at(wrist) + along * (0.06 * stature), 0.018 * stature, SKIN)
    };
    let nose = at(Body25::Nose);
    let forwards = (nose - head).try_normalize(1e-9).unwrap_or(Vector3::zeros());
    let rest = [
        capsule(hips, chest, 0.058 * stature, SHIRT),
        capsule(neck, head, 0.032 * stature, SKIN),
        // As long from the front to the back as a head is, and the nose where its joint is.
        capsule(head, head + forwards * (0.012 * stature), 0.046 * stature, SKIN),
        capsule(head, nose - forwards * (0.010 * stature), 0.010 * stature, SKIN),
        hand(Body25::LeftElbow, Body25::LeftWrist),
        hand(Body25::RightElbow, Body25::RightWrist),
    ];
    limbs.chain(rest)
}

fn capsule(from: Point3<f64>, to: Point3<f64>, radius: f64, colour: [f64; 3]) -> Capsule {
    Capsule { ends: [from, to], radius, colour }
}
