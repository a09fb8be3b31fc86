//! A frame that shows the head at a wrong place.

use nalgebra::{Point3, Vector3};
use proptest::prelude::*;
use vision_models::{Action, Body25, Confidence, Keypoint};

use crate::drive::{Drive, FRAME, doing};

const AHEAD: f64 = 5.5;
/// Radius of the head \[m\].
const FLESH: f64 = 0.1;
/// Number of frames before the wrong one.
const BEFORE: u32 = 12;

fn places() -> [(Body25, Vector3<f64>); 2] {
    [(Body25::Neck, 1.45), (Body25::Nose, 1.62)]
        .map(|(joint, height)| (joint, Vector3::new(AHEAD, 0.0, height)))
}

fn error(length: f64) -> impl Strategy<Value = Vector3<f64>> {
    let direction = prop::array::uniform3(-1.0..1.0)
        .prop_map(Vector3::from)
        .prop_filter("a direction", |direction| direction.norm() > 0.1);
    (direction, 0.0..length).prop_map(|(direction, length)| direction.normalize() * length)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    /// One frame may show neck and nose anywhere. The robot still keeps away from their true place until the next
    /// frame.
    #[test]
    fn misplaced_head_still_counts_at_true_place(
        noise in prop::collection::vec(error(0.02), 2 * (BEFORE as usize + 2)),
        wrong in prop::array::uniform2(error(0.25)),
    ) {
        let mut drive = Drive::fast();
        let mut noise = noise.into_iter();
        for tick in 0..(BEFORE + 1) * FRAME {
            let frame = tick / FRAME;
            if tick.is_multiple_of(FRAME) {
                let mut percept = doing(Action::Walking, drive.time(), Some(AHEAD));
                let body = percept.body.as_mut().unwrap();
                for ((joint, place), wrong) in places().into_iter().zip(wrong) {
                    let error = if frame == BEFORE { wrong } else { noise.next().unwrap() };
                    let position = Point3::from(place + error);
                    body.set(joint, Some(Keypoint { position, confidence: Confidence::ONE }));
                }
                drive.controller.observe(&percept).unwrap();
            }
            let position = drive.robot.position().to_vec();
            drive.controller.step(drive.time(), &position).unwrap();
            drive.tick += 1;
            if tick > 0 {
                let bodies = drive.controller.safety().person_bodies();
                for (joint, place) in places() {
                    let distances = bodies.iter().map(|body| body.capsule.signed_distance(&place));
                    let distance = distances.fold(f64::MAX, f64::min);
                    prop_assert!(distance < -FLESH, "{joint:?} at {distance} m, tick {tick}");
                }
            }
        }
    }
}
