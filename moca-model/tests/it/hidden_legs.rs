//! Legs that the camera does not see, as the robot hides them. Tests where they must be and where they cannot be.

use nalgebra::{Point3, Rotation3, Vector3};
use proptest::prelude::*;
use vision_models::{Action, Body, Body25, Confidence, Keypoint};

use crate::drive::{Drive, FRAME, doing};

/// Distance of the people, who stand or sit far in front of the robot \[m\].
const AHEAD: f64 = 5.5;
/// Radius of a leg about its axis, and the largest error of a joint \[m\].
const FLESH: f64 = 0.08;
const NOISE: f64 = 0.026;
/// Number of ticks in which the whole body is seen, and of all ticks.
const SEEN: u32 = 500;
const TICKS: u32 = 2600;

/// Sets of joints that are not seen.
const HIDDEN: [&[Body25]; 6] = {
    use Body25::{RightAnkle, RightHip, RightKnee};
    [
        &[RightHip],
        &[RightKnee],
        &[RightKnee, RightAnkle],
        &[RightHip, RightKnee],
        &[RightHip, RightAnkle],
        &[RightHip, RightKnee, RightAnkle],
    ]
};

/// Posture of a leg \[rad\]: flexion of the hip, flexion of the knee, and outward rotation of both.
#[derive(Debug, Clone, Copy)]
struct Leg {
    flexion: f64,
    knee: f64,
    outwards: f64,
}

const STRAIGHT: Leg = Leg { flexion: 0.0, knee: 0.0, outwards: 0.0 };

/// The owner of the legs. Segments are fractions of stature by Drillis and Contini (1966).
#[derive(Debug, Clone)]
struct Person {
    stature: f64,
    /// Height of the hips \[m\].
    height: f64,
    /// Distance of each hip from the middle \[m\].
    aside: f64,
    heading: f64,
    /// Error of each joint \[m\].
    noise: Vec<Vector3<f64>>,
}

impl Person {
    /// The joints as coordinates forwards, to the left and up from below the mid hip \[m\].
    fn joints(&self, leg: Leg) -> Vec<(Body25, Vector3<f64>)> {
        let (h, hips) = (self.stature, self.height);
        let outwards = Rotation3::from_axis_angle(&Vector3::z_axis(), -leg.outwards);
        let ahead = |angle: f64| outwards * Vector3::new(angle.sin(), 0.0, -angle.cos());
        let hip = Vector3::new(0.0, -self.aside, hips);
        let knee = hip + ahead(leg.flexion) * 0.245 * h;
        let ankle = knee + ahead(leg.flexion - leg.knee) * 0.246 * h;
        let neck = hips + 0.3 * h;
        let at = |y: f64, z: f64| Vector3::new(0.0, y, z);
        vec![
            (Body25::Neck, at(0.0, neck)),
            (Body25::Nose, at(0.0, neck + 0.1 * h)),
            (Body25::RightShoulder, at(-0.18, neck)),
            (Body25::LeftShoulder, at(0.18, neck)),
            (Body25::RightElbow, at(-0.2, neck - 0.18 * h)),
            (Body25::LeftElbow, at(0.2, neck - 0.18 * h)),
            (Body25::RightWrist, at(-0.2, neck - 0.32 * h)),
            (Body25::LeftWrist, at(0.2, neck - 0.32 * h)),
            (Body25::MidHip, at(0.0, hips)),
            (Body25::LeftHip, at(self.aside, hips)),
            (Body25::RightHip, hip),
            (Body25::RightKnee, knee),
            (Body25::RightAnkle, ankle),
        ]
    }

    fn in_world(&self, place: Vector3<f64>) -> Vector3<f64> {
        let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), self.heading) * place;
        turned + Vector3::x() * AHEAD
    }

    fn body(&self, leg: Leg, hidden: &[Body25]) -> Body {
        let mut body = Body::default();
        let joints = self.joints(leg).into_iter().zip(&self.noise);
        for ((joint, place), noise) in joints.filter(|((joint, _), _)| !hidden.contains(joint)) {
            let position = Point3::from(self.in_world(place) + noise);
            body.set(joint, Some(Keypoint { position, confidence: Confidence::ONE }));
        }
        body
    }

    /// The distances of `points` from the person's bodies, where `points` are given as joints \[m\]. The leg has been
    /// straight and seen before, and then has this posture and is hidden.
    fn distances(&self, leg: Leg, hidden: &[Body25], points: &[Vector3<f64>]) -> Vec<f64> {
        let mut drive = Drive::fast();
        for tick in 0..TICKS {
            if tick.is_multiple_of(FRAME) {
                let mut percept = doing(Action::Walking, drive.time(), Some(AHEAD));
                percept.body = Some(match tick {
                    0..SEEN => self.body(STRAIGHT, &[]),
                    _ => self.body(leg, hidden),
                });
                drive.controller.observe(&percept).unwrap();
            }
            let position = drive.robot.position().to_vec();
            drive.controller.step(drive.time(), &position).unwrap();
            drive.tick += 1;
        }
        let bodies = drive.controller.safety().person_bodies();
        let nearest = |point: &Vector3<f64>| {
            let point = self.in_world(*point);
            let distances = bodies.iter().map(|body| body.capsule.signed_distance(&point));
            distances.fold(f64::MAX, f64::min)
        };
        points.iter().map(nearest).collect()
    }
}

/// People who stand, walk, climb or sit, with a leg in such a posture.
fn people() -> impl Strategy<Value = (Person, Leg)> {
    let noise = prop::collection::vec(prop::array::uniform3(-NOISE..NOISE), 13);
    let standing = (-0.35..1.05, 0.0..1.4).prop_map(|(flexion, knee)| (false, flexion, knee));
    let sitting = (1.3..1.57, -0.2..0.4)
        .prop_map(|(flexion, bent): (f64, f64)| (true, flexion, flexion + bent));
    let posture = prop_oneof![standing, sitting];
    (1.5..2.0, posture, 0.07..0.12, -3.1..3.1, -0.1..0.35, noise).prop_map(
        |(stature, (sits, flexion, knee), aside, heading, outwards, noise)| {
            // The foot of a sitting person is on the floor.
            let leg = 0.245 * f64::cos(flexion) + 0.246 * f64::cos(flexion - knee);
            let height = if sits { 0.05 + leg * stature } else { 0.53 * stature };
            let noise =
                noise.into_iter().map(|noise| Vector3::from(noise) / 3.0_f64.sqrt()).collect();
            // Nobody kicks: the foot is not far in front of the knee or behind it.
            let knee = knee.clamp(flexion - 0.2, flexion + 1.0);
            (Person { stature, height, aside, heading, noise }, Leg { flexion, knee, outwards })
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    /// A hidden leg is within the bodies that represent it, a thigh with its flesh.
    #[test]
    fn hidden_leg_is_within_its_assumed_bodies(
        (person, leg) in people(),
        hidden in prop::sample::select(&HIDDEN),
    ) {
        let joints = person.joints(leg);
        let of = |joint| joints.iter().find(|(other, _)| *other == joint).unwrap().1;
        let [hip, knee, ankle] = [Body25::RightHip, Body25::RightKnee, Body25::RightAnkle].map(of);
        let along = |from: &Vector3<f64>, to: &Vector3<f64>| {
            [0.0, 0.25, 0.5, 0.75, 1.0].map(|share| from.lerp(to, share))
        };
        let (thigh, shank) = (along(&hip, &knee), along(&knee, &ankle));
        let points = [thigh, shank].concat();
        let distances = person.distances(leg, hidden, &points);
        for (index, (point, distance)) in points.iter().zip(distances).enumerate() {
            // The largest lower legs are within a step, except for some centimetres of flesh.
            let most = if index < thigh.len() { NOISE - FLESH } else { 0.0 };
            prop_assert!(distance < most, "{point:?} is {distance} m outside");
        }
    }
}

/// A hidden leg does not keep the robot from the place of the hands.
#[test]
fn hidden_leg_leaves_room_for_the_hands() {
    use Body25::{RightAnkle, RightHip, RightKnee};
    let person = Person {
        stature: 1.75,
        height: 0.93,
        aside: 0.09,
        heading: 0.0,
        noise: vec![Vector3::zeros(); 13],
    };
    let room = |hidden: &[Body25], (ahead, above): (f64, f64)| {
        let hand = Vector3::new(ahead, 0.0, person.height + above);
        person.distances(STRAIGHT, hidden, &[hand])[0]
    };
    // The points are between mid hip and a knee that is seen.
    for ahead in [-0.45, 0.45] {
        assert!(room(&[RightHip], (ahead, 0.1)) > 0.1);
    }
    // The points are below the hip, which is seen, or is at mid hip except for its width.
    for ahead in [-0.45, 0.45] {
        assert!(room(&[RightKnee, RightAnkle], (ahead, 0.3)) > 0.02);
        assert!(room(&[RightHip, RightKnee, RightAnkle], (ahead, 0.5)) > 0.02);
    }
}
