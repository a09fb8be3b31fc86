//! Joints that the body itself hides from the camera. Pose networks state them with full confidence.

use nalgebra::Point2;

use super::lifter::Look;
use crate::body::Body25;

/// Joints of the face.
const FACE: [Body25; 3] = [Body25::Nose, Body25::LeftEye, Body25::RightEye];

/// Cosine of the bearing of the camera from which the skull hides the face: 110° off the forward direction.
const FACE_AWAY: f64 = -0.34;

/// Hip, knee and ankle of each leg.
const LEGS: [[Body25; 3]; 2] = [
    [Body25::LeftHip, Body25::LeftKnee, Body25::LeftAnkle],
    [Body25::RightHip, Body25::RightKnee, Body25::RightAnkle],
];
/// Joints of each foot. They count as hidden with the ankle.
const FEET: [[Body25; 3]; 2] = [
    [Body25::LeftHeel, Body25::LeftBigToe, Body25::LeftSmallToe],
    [Body25::RightHeel, Body25::RightBigToe, Body25::RightSmallToe],
];

/// Radius of a leg (m). A joint nearer to the middle of the other leg in the image is before or behind that leg.
const LEG_RADIUS: f64 = 0.08;

/// Largest difference of depths on the surface of one leg (m).
const SAME_SURFACE: f64 = 0.1;

/// Sine of the bearing of the camera beyond which the leg on its side is the nearer one.
const ASIDE: f64 = 0.5;

/// Standard deviation of the place of a joint along the ray if it may be behind the other leg (m). Legs in a stride are
/// up to 0.3 m apart.
pub(super) const OTHER_LEG_SIGMA: f64 = 0.1;

/// Returns true if the head hides this joint. `bearing` is the direction to the camera relative to the person's forward
/// direction (rad).
pub(super) fn is_behind_skull(joint: Body25, bearing: f64) -> bool {
    FACE.contains(&joint) && bearing.cos() < FACE_AWAY
}

/// Returns the joints of legs that may be behind the other leg, since they show its surface.
///
/// Where the legs overlap in the image, the depth there is that of the nearer leg. A camera to the left of the person sees
/// the left leg; from the front and from behind either may be the nearer one. `bearing` is the direction to the camera
/// relative to the person's forward direction, positive to the left (rad). `focal` is the focal length (pixels).
pub(super) fn behind_other_leg(
    seen: &[Option<Look>; Body25::COUNT],
    bearing: Option<f64>,
    focal: f64,
) -> [bool; Body25::COUNT] {
    let mut hidden = [false; Body25::COUNT];
    let look = |joint: Body25| seen[joint.index()].as_ref();
    let aside = bearing.map_or(0.0, f64::sin);
    let sides = [(0, 1, aside), (1, 0, -aside)];
    for (own, other, towards_camera) in sides {
        if towards_camera > ASIDE {
            continue;
        }
        let [hip, knee, ankle] = LEGS[other].map(look);
        let overlaps = |joint: Body25| {
            let shows = |upper: Option<&Look>, lower: Option<&Look>| {
                let (Some(joint), Some(upper), Some(lower)) = (look(joint), upper, lower) else {
                    return false;
                };
                shows_part(joint, [upper, lower], focal)
            };
            shows(hip, knee) || shows(knee, ankle)
        };
        let [_, knee, ankle] = LEGS[own];
        hidden[knee.index()] = overlaps(knee);
        hidden[ankle.index()] = overlaps(ankle);
        for joint in FEET[own] {
            hidden[joint.index()] = hidden[ankle.index()];
        }
    }
    hidden
}

/// Returns true if a joint is within the radius of the part of a leg between two joints in the image, and at its depth.
fn shows_part(joint: &Look, [upper, lower]: [&Look; 2], focal: f64) -> bool {
    let pixel = |look: &Look| look.keypoint.position;
    let depth = |look: &Look| look.surface.depth;
    let share = nearest_share(pixel(joint), [pixel(upper), pixel(lower)]);
    let middle = pixel(upper) + (pixel(lower) - pixel(upper)) * share;
    let surface = depth(upper) + (depth(lower) - depth(upper)) * share;
    let apart = (pixel(joint) - middle).norm() * depth(joint) / focal;
    apart < LEG_RADIUS && (depth(joint) - surface).abs() < SAME_SURFACE
}

/// Returns the share of the way between two points at which the line is nearest to `point`.
fn nearest_share(point: Point2<f64>, [from, to]: [Point2<f64>; 2]) -> f64 {
    let way = to - from;
    let square = way.norm_squared();
    if square > 0.0 { ((point - from).dot(&way) / square).clamp(0.0, 1.0) } else { 0.0 }
}
