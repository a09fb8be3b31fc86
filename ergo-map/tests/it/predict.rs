//! Posture prediction.

use crate::support::Random;
use ergo_map::{
    EffortWeights, Error, HandTarget, JointAngles, Person, PosturePredictor, Prediction, Region,
    Side, Skeleton,
};
use nalgebra::{Rotation3, Vector3};
use proptest::prelude::*;

/// Returns a point of the work zone of a person of 1.75 m, from three fractions.
fn in_work_zone(t: [f64; 3], side: Side) -> Vector3<f64> {
    let zone = Region::work_zone(1.75, side);
    zone.min() + zone.size().component_mul(&Vector3::from(t))
}

fn start(random: &mut Random, person: &Person) -> JointAngles {
    let (min, max) = (person.ranges().min.to_array(), person.ranges().max.to_array());
    JointAngles::from_array(core::array::from_fn(|i| random.uniform(min[i], max[i])))
}

/// Returns the largest difference of two postures in the joints that affect a point \[rad\].
fn apart(a: &Prediction, b: &Prediction) -> f64 {
    let pairs = a.angles.to_array().into_iter().zip(b.angles.to_array());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn random_starts_come_to_the_same_posture() {
    let person = Person::average();
    let predictor = PosturePredictor::new(&person, Side::Right);
    let mut random = Random(41);
    let (mut same, mut best, mut runs) = (0, 0, 0);
    for _ in 0..200 {
        let t = core::array::from_fn(|_| random.uniform(0.0, 1.0));
        let target = HandTarget::point(in_work_zone(t, Side::Right));
        let Ok(reference) = predictor.predict(&target) else { continue };
        for _ in 0..5 {
            runs += 1;
            let other = predictor.predict_from(&target, &start(&mut random, &person));
            let Ok(other) = other else { continue };
            same += usize::from(apart(&reference, &other) < 0.01);
            best += usize::from(reference.effort <= other.effort + 1e-6);
        }
    }
    let share = |n: usize| n as f64 / f64::from(runs);
    println!(
        "{runs} random starts: same posture {:.4}, none better {:.4}",
        share(same),
        share(best)
    );
    assert!(runs > 900);
    assert!(share(same) >= 0.95, "{}", share(same));
    assert!(share(best) >= 0.98, "{}", share(best));
}

#[test]
fn out_of_reach_is_a_typed_answer() {
    let predictor = PosturePredictor::new(&Person::average(), Side::Right);
    let reason = |x, y, z| match predictor.predict(&HandTarget::point(Vector3::new(x, y, z))) {
        Err(Error::Unreachable { reason, .. }) => reason,
        other => panic!("{other:?}"),
    };
    assert!(reason(0.0, 0.0, 3.0).starts_with("the closest posture leaves it "));
    let distance = reason(1.3, -0.2, 0.9)
        .strip_prefix("the closest posture in balance leaves it ")
        .and_then(|rest| rest.strip_suffix(" m away")?.parse::<f64>().ok());
    assert!(distance.is_some_and(|distance| distance > 0.05));
    assert_eq!(reason(0.0, 0.0, 1.2), "it lies inside the person's trunk");
    let nan = HandTarget::point(Vector3::new(0.4, f64::NAN, 1.0));
    assert!(matches!(predictor.predict(&nan), Err(Error::Value { what: "y", .. })));
    let point = HandTarget::point(Vector3::new(0.4, -0.2, 1.0));
    let start = JointAngles { knee: f64::NAN, ..JointAngles::default() };
    assert!(matches!(
        predictor.predict_from(&point, &start),
        Err(Error::Value { what: "knee", .. })
    ));
    let message = predictor.predict(&HandTarget::point(Vector3::x() * 2.0)).unwrap_err();
    println!("{message}");
}

#[test]
fn weights_are_checked() {
    let person = Person::average();
    for weights in [
        EffortWeights { gravity: -1.0, ..EffortWeights::default() },
        EffortWeights { gaze: f64::NAN, ..EffortWeights::default() },
        EffortWeights { displacement: JointAngles::default(), ..EffortWeights::default() },
    ] {
        assert!(PosturePredictor::with_weights(&person, Side::Right, &weights).is_err());
    }
}

#[test]
fn a_comfortable_point_gets_a_comfortable_posture() {
    let predictor = PosturePredictor::new(&Person::average(), Side::Right);
    let at = |x, y, z| predictor.predict(&HandTarget::point(Vector3::new(x, y, z))).unwrap();
    let near = at(0.38, -0.2, 1.05).angles;
    assert!(near.posture().trunk_flexion.abs() < 0.06, "{near:?}");
    assert!((0.9..1.7).contains(&near.elbow), "{near:?}");
    // The arm stretches and the trunk leans to reach a farther point. The trunk leans more for a
    // lower point.
    let far = at(0.75, -0.2, 1.05).angles;
    assert!(far.elbow < near.elbow && far.posture().trunk_flexion > near.posture().trunk_flexion);
    let low = at(0.4, -0.2, 0.5).angles;
    assert!(low.posture().trunk_flexion > 0.5, "{low:?}");
    // The arm rises to reach an overhead point.
    assert!(at(0.3, -0.2, 1.85).angles.shoulder_flexion > 1.2);
}

#[test]
fn a_load_in_the_hand_costs_effort() {
    let person = Person::average();
    let target = HandTarget::point(Vector3::new(0.55, -0.2, 1.1));
    let heavy = EffortWeights { load: 10.0, ..EffortWeights::default() };
    let light = PosturePredictor::new(&person, Side::Right).predict(&target).unwrap();
    let heavy = PosturePredictor::with_weights(&person, Side::Right, &heavy).unwrap();
    assert!(heavy.predict(&target).unwrap().effort > light.effort);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn the_hand_arrives_within_the_joints_limits(
        t in proptest::array::uniform3(0.0..1.0_f64),
        stature in 1.4..2.1_f64,
        left: bool,
    ) {
        let side = if left { Side::Left } else { Side::Right };
        let person = Person::new(stature).unwrap();
        let target = in_work_zone(t, side) * (stature / 1.75);
        let predicted = PosturePredictor::new(&person, side).predict(&HandTarget::point(target));
        // Only corners of the work zone may be out of reach.
        if let Ok(prediction) = predicted {
            let body = Skeleton::new(&person, side).landmarks(&prediction.angles).unwrap();
            prop_assert!((body.hand - target).norm() <= 5e-4);
            prop_assert!(((body.hand - target).norm() - prediction.hand_error).abs() < 1e-9);
            prop_assert!(person.ranges().contains(&prediction.angles));
            // The centre of mass is over the feet, within the tolerance of the guard.
            let foot = person.segments().foot.unwrap();
            let x = body.centre_of_mass.x;
            prop_assert!((-0.25 * foot - 0.01..=0.75 * foot + 0.01).contains(&x), "{x}");
        } else {
            prop_assert!(t.iter().any(|t| *t < 0.1 || *t > 0.9), "{predicted:?}");
        }
    }

    #[test]
    fn people_of_equal_proportions_take_equal_postures(
        t in proptest::array::uniform3(0.1..0.9_f64),
        stature in 1.4..2.1_f64,
    ) {
        let target = in_work_zone(t, Side::Right);
        let predict = |person: &Person, target: Vector3<f64>| {
            PosturePredictor::new(person, Side::Right).predict(&HandTarget::point(target)).unwrap()
        };
        let average = predict(&Person::average(), target);
        let other = predict(&Person::new(stature).unwrap(), target * (stature / 1.75));
        prop_assert!(apart(&average, &other) < 1e-6, "{}", apart(&average, &other));
    }

    #[test]
    fn the_left_hand_mirrors_the_right(t in proptest::array::uniform3(0.1..0.9_f64)) {
        let right = in_work_zone(t, Side::Right);
        let left = Vector3::new(right.x, -right.y, right.z);
        let person = Person::average();
        let predict = |side, target| {
            PosturePredictor::new(&person, side).predict(&HandTarget::point(target)).unwrap()
        };
        let (right, left) = (predict(Side::Right, right), predict(Side::Left, left));
        prop_assert_eq!(right.angles.mirrored(), left.angles);
    }

    #[test]
    fn neighbouring_targets_get_neighbouring_postures(
        t in proptest::array::uniform3(0.1..0.9_f64),
        way in proptest::array::uniform3(-1.0..1.0_f64),
    ) {
        let predictor = PosturePredictor::new(&Person::average(), Side::Right);
        let target = in_work_zone(t, Side::Right);
        let nearby = target + Vector3::from(way) * 1e-3;
        let [a, b] =
            [target, nearby].map(|p| predictor.predict(&HandTarget::point(p)).unwrap());
        prop_assert!(apart(&a, &b) < 0.05, "{}", apart(&a, &b));
    }

    #[test]
    fn an_oriented_hand_arrives_in_its_orientation(
        t in proptest::array::uniform3(0.25..0.75_f64),
        turn in prop_oneof![Just([0.0; 3]), proptest::array::uniform3(-0.4..0.4_f64)],
        left: bool,
    ) {
        let side = if left { Side::Left } else { Side::Right };
        let person = Person::average();
        // The target is the orientation that the hand has by itself, turned a little.
        let position = in_work_zone(t, side);
        let predictor = PosturePredictor::new(&person, side);
        let free = predictor.predict(&HandTarget::point(position)).unwrap();
        let skeleton = Skeleton::new(&person, side);
        let natural = skeleton.landmarks(&free.angles).unwrap().hand_orientation;
        let orientation = Rotation3::new(Vector3::from(turn)) * natural;
        let target = HandTarget { position, orientation: Some(orientation) };
        match predictor.predict(&target) {
            Ok(prediction) => {
                let hand = skeleton.landmarks(&prediction.angles).unwrap();
                prop_assert!((hand.hand - position).norm() <= 5e-4);
                prop_assert!(hand.hand_orientation.angle_to(&orientation) < 2e-3);
                prop_assert!(person.ranges().contains(&prediction.angles));
                // If the orientation is the hand's own, the freedom of the wrist lowers the effort.
                if turn == [0.0; 3] {
                    prop_assert!(prediction.effort <= free.effort + 1e-6);
                }
            }
            Err(error) => {
                let wrist = Vector3::from(turn).norm() > 0.25;
                prop_assert!(wrist, "{error}");
            }
        }
    }

    #[test]
    fn no_numbers_panic(
        position in proptest::array::uniform3(any::<f64>()),
        far in proptest::array::uniform3(-1e3..1e3_f64),
        start in proptest::array::uniform15(any::<f64>()),
    ) {
        let predictor = PosturePredictor::new(&Person::average(), Side::Right);
        for position in [position, far] {
            let target = HandTarget::point(Vector3::from(position));
            let start = JointAngles::from_array(start);
            let both = [predictor.predict(&target), predictor.predict_from(&target, &start)];
            for prediction in both.into_iter().flatten() {
                prop_assert!(prediction.hand_error <= 5e-4 && prediction.effort.is_finite());
            }
        }
    }
}
