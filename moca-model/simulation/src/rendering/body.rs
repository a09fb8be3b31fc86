//! The capsules of the person.

use nalgebra::{Point3, Vector3};
use simulated_people::Joints;
use vision_models::Body25;

use super::{
    appearance::{Appearance, Colour},
    shape::Capsule,
};

/// The covering of a segment.
#[derive(Clone, Copy, Debug)]
enum Part {
    Skin,
    Shirt,
    Trousers,
    Shoes,
}

impl Part {
    fn colour(self, appearance: &Appearance) -> Colour {
        match self {
            Self::Skin => appearance.skin,
            Self::Shirt => appearance.shirt,
            Self::Trousers => appearance.trousers,
            Self::Shoes => appearance.shoes,
        }
    }
}

/// Segments between two joints with their radii as fractions of stature, for an adult in working clothes.
const SEGMENTS: [(Body25, Body25, f64, Part); 14] = {
    use Body25::{
        LeftAnkle, LeftBigToe, LeftElbow, LeftHip, LeftKnee, LeftShoulder, LeftWrist, RightAnkle,
        RightBigToe, RightElbow, RightHip, RightKnee, RightShoulder, RightWrist,
    };
    use Part::{Shirt, Shoes, Skin, Trousers};
    [
        (LeftHip, RightHip, 0.056, Trousers),
        (LeftShoulder, RightShoulder, 0.037, Shirt),
        (LeftShoulder, LeftElbow, 0.026, Shirt),
        (RightShoulder, RightElbow, 0.026, Shirt),
        (LeftElbow, LeftWrist, 0.019, Skin),
        (RightElbow, RightWrist, 0.019, Skin),
        (LeftHip, LeftKnee, 0.042, Trousers),
        (RightHip, RightKnee, 0.042, Trousers),
        (LeftKnee, LeftAnkle, 0.024, Trousers),
        (RightKnee, RightAnkle, 0.024, Trousers),
        (LeftAnkle, LeftBigToe, 0.022, Shoes),
        (RightAnkle, RightBigToe, 0.022, Shoes),
        (LeftHip, LeftShoulder, 0.050, Shirt),
        (RightHip, RightShoulder, 0.050, Shirt),
    ]
};

/// The capsules of a person with these joints \[m, world\], in the world.
pub(super) fn capsules<'a>(
    joints: &'a Joints,
    stature: f64,
    appearance: &'a Appearance,
) -> impl Iterator<Item = Capsule> + 'a {
    let Appearance { skin, shirt, .. } = *appearance;
    let at = |joint: Body25| joints[joint.index()];
    let limbs = SEGMENTS.into_iter().map(move |(from, to, radius, part)| Capsule {
        ends: [at(from), at(to)],
        radius: radius * stature,
        colour: part.colour(appearance),
    });
    let (hips, neck) = (at(Body25::MidHip), at(Body25::Neck));
    let head = nalgebra::center(&at(Body25::LeftEar), &at(Body25::RightEar));
    // Shoulders are at the top of the trunk. The chest ends below them.
    let chest = hips + (neck - hips) * 0.75;
    let hand = |elbow: Body25, wrist: Body25| {
        let along = (at(wrist) - at(elbow)).try_normalize(1e-9).unwrap_or(Vector3::zeros());
        capsule(at(wrist), at(wrist) + along * (0.06 * stature), 0.018 * stature, skin)
    };
    let nose = at(Body25::Nose);
    let forwards = (nose - head).try_normalize(1e-9).unwrap_or(Vector3::zeros());
    let rest = [
        capsule(hips, chest, 0.058 * stature, shirt),
        capsule(neck, head, 0.032 * stature, skin),
        // The head has its length from front to back, with the nose at its joint.
        capsule(head, head + forwards * (0.012 * stature), 0.046 * stature, skin),
        capsule(head, nose - forwards * (0.010 * stature), 0.010 * stature, skin),
        hand(Body25::LeftElbow, Body25::LeftWrist),
        hand(Body25::RightElbow, Body25::RightWrist),
    ];
    limbs.chain(rest)
}

fn capsule(from: Point3<f64>, to: Point3<f64>, radius: f64, colour: [f64; 3]) -> Capsule {
    Capsule { ends: [from, to], radius, colour }
}
