//! The joints of the moving person.
//!
//! Heights and lengths are fractions of stature from Drillis & Contini (1966). The half widths at shoulders and hips
//! are those of the joints' centres.

use nalgebra::{Isometry3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};
use vision_models::Body25;

use super::arm::{FOREARM, STRETCHED, UPPER_ARM, bend};
use super::joints::Joints;
use super::motion::Motion;

const ANKLE_HEIGHT: f64 = 0.039;
const SHANK: f64 = 0.285 - 0.039;
const THIGH: f64 = 0.530 - 0.285;
const TRUNK: f64 = 0.818 - 0.530;
const SHOULDER: f64 = 0.118;
const HIP: f64 = 0.055;
/// Distance of the ears in front of the shoulders of an upright person: by 24° from the vertical.
const FACE: f64 = 0.05;
/// Half the distance between the feet, which stand a little wider than the hips.
const FOOT: f64 = 0.07;
/// Distance from a shoulder, aside or up, within which a hand is moved forwards.
const NEAR_SHOULDER: f64 = 0.13;
/// Distance that it then has before the shoulder. An elbow that is bent by 148° has the wrist there.
const BEFORE_SHOULDER: f64 = 0.1;
/// Length of a straight leg, which is not locked.
const LEG: f64 = 0.99 * (THIGH + SHANK);

/// The twenty-five joints of a person of this stature \[m\], in the world, in the order of `BODY_25`.
pub(super) fn joints(stature: f64, motion: &Motion) -> Joints {
    let mut joints = [Point3::origin(); Body25::COUNT];
    let mut set = |joint: Body25, place: Vector3<f64>| joints[joint.index()] = place.into();

    let posture = motion.moving.posture();
    let sway = (motion.sway() / stature).push(0.0);
    let feet = [(true, 1.0), (false, -1.0)].map(|(left, side)| {
        let foot = motion.foot(left) / stature;
        foot + Vector3::new(0.0, side * FOOT, ANKLE_HEIGHT)
    });
    // The pelvis is as high as the leg that is stretched further allows.
    let pelvis_height = [1.0, -1.0]
        .into_iter()
        .zip(feet)
        .map(|(side, foot)| {
            let aside = (foot - sway - Vector3::y() * (side * HIP)).xy().norm();
            foot.z + (LEG * LEG - aside * aside).max(0.0).sqrt()
        })
        .fold(f64::INFINITY, f64::min);
    let feet = feet.map(|foot| foot - Vector3::x() * posture.feet_back);
    let standing = Vector3::new(0.0, 0.0, pelvis_height);
    let pelvis = standing + sway - Vector3::new(posture.back, 0.0, posture.drop);
    let neck = pelvis + trunk(motion.lean() + posture.lean, posture.aside);
    let carried = carried(motion);
    let bent = Rotation3::from_axis_angle(&Vector3::x_axis(), -posture.aside)
        * Rotation3::from_axis_angle(&Vector3::y_axis(), posture.lean);
    let of_head = |x: f64, y: f64, z: f64| neck + bent * Vector3::new(x, y, z);
    set(Body25::MidHip, pelvis);
    set(Body25::Neck, neck);
    set(Body25::Nose, of_head(FACE + 0.06, 0.0, 0.092));

    let hand = |left: bool| motion.hand(left) + carried + posture.hands[usize::from(!left)];
    for (joints, side, foot, hand) in
        [(&LEFT, 1.0, feet[0], hand(true)), (&RIGHT, -1.0, feet[1], hand(false))]
    {
        let lateral = Vector3::y() * side;
        let hip = pelvis + lateral * HIP;
        set(joints.hip, hip);
        set(joints.knee, bend(hip, foot, THIGH, SHANK, Vector3::x()));
        set(joints.ankle, foot);
        set(joints.heel, foot + Vector3::new(-0.035, 0.0, -0.03));
        set(joints.big_toe, foot + Vector3::new(0.11, -side * 0.01, -0.03));
        set(joints.small_toe, foot + Vector3::new(0.09, side * 0.03, -0.03));

        let shoulder = neck + bent * (lateral * SHOULDER);
        // The hand goes no further than the arm reaches.
        let hand = past_shoulder(hand - shoulder).cap_magnitude(STRETCHED * (UPPER_ARM + FOREARM));
        let hand = shoulder + hand;
        set(joints.shoulder, shoulder);
        set(joints.elbow, bend(shoulder, hand, UPPER_ARM, FOREARM, motion.elbow(side > 0.0)));
        set(joints.wrist, hand);
        set(joints.eye, of_head(FACE + 0.05, side * 0.018, 0.118));
        set(joints.ear, of_head(FACE, side * 0.043, 0.11));
    }

    let world_from_person = world_from_person(stature, motion);
    joints.map(|joint| world_from_person * (joint * stature))
}

/// The hand's place relative to the shoulder, moved forwards near it: an elbow cannot fold the forearm onto the upper
/// arm.
fn past_shoulder(hand: Vector3<f64>) -> Vector3<f64> {
    let near = (1.0 - hand.yz().norm_squared() / (NEAR_SHOULDER * NEAR_SHOULDER)).max(0.0);
    hand + Vector3::x() * (near * near * (BEFORE_SHOULDER - hand.x).max(0.0))
}

/// The pose of the person's frame, in the world.
pub(super) fn world_from_person(stature: f64, motion: &Motion) -> Isometry3<f64> {
    let posture = motion.moving.posture();
    Isometry3::from_parts(
        Translation3::new(motion.floor.x, motion.floor.y, 0.0),
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), motion.heading),
    ) * Isometry3::from_parts(
        Translation3::new(0.0, posture.step * stature, 0.0),
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), posture.turn),
    )
}

/// Vector from pelvis to neck, as a fraction of stature, leaning so far forwards and to the left (rad).
fn trunk(lean: f64, aside: f64) -> Vector3<f64> {
    let (sin, cos) = lean.sin_cos();
    Vector3::new(sin * aside.cos(), aside.sin(), cos * aside.cos()) * TRUNK
}

/// Shift of the arms, which hang on the trunk, when the body bends, as a fraction of stature.
pub(super) fn carried(motion: &Motion) -> Vector3<f64> {
    let posture = motion.moving.posture();
    let bent = trunk(motion.lean() + posture.lean, posture.aside) - trunk(motion.lean(), 0.0);
    bent - Vector3::new(posture.back, 0.0, posture.drop)
}

/// The joints of one side.
struct Side {
    hip: Body25,
    knee: Body25,
    ankle: Body25,
    heel: Body25,
    big_toe: Body25,
    small_toe: Body25,
    shoulder: Body25,
    elbow: Body25,
    wrist: Body25,
    eye: Body25,
    ear: Body25,
}

const LEFT: Side = Side {
    hip: Body25::LeftHip,
    knee: Body25::LeftKnee,
    ankle: Body25::LeftAnkle,
    heel: Body25::LeftHeel,
    big_toe: Body25::LeftBigToe,
    small_toe: Body25::LeftSmallToe,
    shoulder: Body25::LeftShoulder,
    elbow: Body25::LeftElbow,
    wrist: Body25::LeftWrist,
    eye: Body25::LeftEye,
    ear: Body25::LeftEar,
};

const RIGHT: Side = Side {
    hip: Body25::RightHip,
    knee: Body25::RightKnee,
    ankle: Body25::RightAnkle,
    heel: Body25::RightHeel,
    big_toe: Body25::RightBigToe,
    small_toe: Body25::RightSmallToe,
    shoulder: Body25::RightShoulder,
    elbow: Body25::RightElbow,
    wrist: Body25::RightWrist,
    eye: Body25::RightEye,
    ear: Body25::RightEar,
};

#[cfg(test)]
mod tests {
    use nalgebra::{Point2, vector};

    use super::*;
    use crate::motion::{Gait, Goal, Hands};

    fn natural(floor: Point2<f64>, heading: f64) -> Motion {
        Motion::starting_at(floor, heading, Gait::NATURAL, Hands::Carrying)
    }

    /// Frames of a walk over 2 m with the hands in each place.
    fn walk() -> impl Iterator<Item = (f64, Motion)> {
        [Hands::Swinging, Hands::Working, Hands::AtTable, Hands::Reaching].into_iter().flat_map(
            |hands| {
                let gait = Gait { sway: 1.0, ..Gait::NATURAL };
                let mut motion =
                    Motion::starting_at(Point2::new(3.0, 0.0), 3.0, gait, Hands::Carrying);
                let goal =
                    Goal { floor: Point2::new(1.0, 0.0), heading: 4.0, speed: 0.9, stop: true };
                (0..100).map(move |frame| {
                    motion.advance(&goal, hands, 0.05);
                    (1.5 + 0.005 * f64::from(frame), motion.clone())
                })
            },
        )
    }

    #[test]
    fn segments_keep_their_lengths() {
        use Body25::{
            LeftAnkle, LeftElbow, LeftHip, LeftKnee, LeftShoulder, LeftWrist, RightAnkle,
            RightElbow, RightHip, RightKnee, RightShoulder, RightWrist,
        };
        for (stature, motion) in walk() {
            let joints = joints(stature, &motion);
            let at = |joint: Body25| joints[joint.index()];
            for (from, to, fraction) in [
                (LeftHip, LeftKnee, THIGH),
                (RightHip, RightKnee, THIGH),
                (LeftKnee, LeftAnkle, SHANK),
                (RightKnee, RightAnkle, SHANK),
                (LeftShoulder, LeftElbow, UPPER_ARM),
                (RightShoulder, RightElbow, UPPER_ARM),
                (LeftElbow, LeftWrist, FOREARM),
                (RightElbow, RightWrist, FOREARM),
            ] {
                let length = (at(to) - at(from)).norm() / stature;
                assert!((length - fraction).abs() < 1e-9, "{from:?} to {to:?}: {length}");
            }
        }
    }

    #[test]
    fn feet_are_on_floor_and_head_up() {
        for (stature, motion) in walk() {
            let joints = joints(stature, &motion);
            let lowest = joints.iter().map(|joint| joint.z).fold(f64::INFINITY, f64::min);
            assert!(lowest >= 0.0 && lowest < 0.02 * stature, "a foot stands: {lowest} m");
            let eyes = joints[Body25::LeftEye.index()].z / stature;
            assert!((0.89..0.95).contains(&eyes), "eyes at {eyes} of stature");
        }
    }

    /// Speed of the mid hip relative to its mean over a minute, root mean square, of a person who walks at this speed
    /// \[m/s\].
    fn unevenness(speed: f64, sway: f64) -> f64 {
        let gait = Gait { sway, ..Gait::NATURAL };
        let mut motion = Motion::starting_at(Point2::origin(), 0.3, gait, Hands::Working);
        let goal = Goal { floor: Point2::new(900.0, 300.0), heading: 0.3, speed, stop: false };
        motion.advance(&goal, Hands::Working, 5.0);
        let place = |motion: &Motion| joints(1.75, motion)[Body25::MidHip.index()].xy();
        let places: Vec<_> = (0..6000)
            .map(|_| {
                motion.advance(&goal, Hands::Working, 0.01);
                place(&motion)
            })
            .collect();
        let mean = (places[5999] - places[0]) / 59.99;
        let squares =
            places.windows(2).map(|pair| ((pair[1] - pair[0]) / 0.01 - mean).norm_squared());
        (squares.sum::<f64>() / 5999.0).sqrt()
    }

    #[test]
    fn pelvis_moves_like_that_of_filmed_people() {
        // On film 0.16 m/s at 1.06 m/s; the literature has 0.01 to 0.03 m/s for people who stand and work.
        let (walking, standing) = (unevenness(1.06, 1.0), unevenness(0.0, 1.0));
        assert!((walking - 0.16).abs() < 0.02, "{walking} m/s");
        assert!((0.01..0.03).contains(&standing), "{standing} m/s");
        assert!(unevenness(1.06, 0.0) < 1e-6);
    }

    #[test]
    fn a_standing_foot_stays_where_it_is() {
        let mut motion = natural(Point2::new(0.0, 0.0), 0.0);
        let goal = Goal { floor: Point2::new(50.0, 0.0), heading: 0.0, speed: 0.8, stop: false };
        motion.advance(&goal, Hands::Swinging, 3.0);
        let mut before: Option<(Vector3<f64>, f64)> = None;
        for _ in 0..200 {
            motion.advance(&goal, Hands::Swinging, 0.01);
            let foot = motion.foot(true);
            let place = motion.floor.x + foot.x;
            if let Some((last, last_place)) = before.filter(|(last, _)| last.z.max(foot.z) == 0.0) {
                assert!((place - last_place).abs() < 1e-9, "slid from {last:?} to {foot:?}");
            }
            before = Some((foot, place));
        }
        assert!((motion.velocity - vector![0.8, 0.0]).norm() < 1e-9);
    }
}
