//! Properties that the tracker must have for any input.

mod ids;

use std::f64::consts::{PI, TAU};

use nalgebra::{Isometry3, Point2, Point3, Translation3, UnitQuaternion, Vector2, Vector3, vector};
use proptest::prelude::*;
use vision_models::{
    Body, Body25, BodyTracker, Confidence, Error, Freshness, Keypoint, Percept, TrackedPerson,
    TrackerSettings,
};

const FRAME: f64 = 0.05;

fn keypoint(x: f64, y: f64, z: f64) -> Keypoint {
    let confidence = Confidence::new(0.9).unwrap();
    Keypoint { position: Point3::new(x, y, z), confidence }
}

/// Returns an upright person of 1.75 m with the pelvis above the origin, looking along x.
fn person() -> Body {
    let mut body = Body::default();
    for (joint, x, y, z) in [
        (Body25::Neck, 0.0, 0.0, 1.43),
        (Body25::LeftShoulder, 0.0, 0.2, 1.43),
        (Body25::RightShoulder, 0.0, -0.2, 1.43),
        (Body25::MidHip, 0.0, 0.0, 0.9275),
        (Body25::LeftHip, 0.0, 0.1, 0.9275),
        (Body25::RightHip, 0.0, -0.1, 0.9275),
        (Body25::LeftKnee, 0.0, 0.1, 0.49875),
        (Body25::RightKnee, 0.0, -0.1, 0.49875),
        (Body25::LeftAnkle, 0.0, 0.1, 0.06825),
        (Body25::RightAnkle, 0.0, -0.1, 0.06825),
    ] {
        body.set(joint, Some(keypoint(x, y, z)));
    }
    body
}

fn on_floor(floor: Vector2<f64>, heading: f64) -> Isometry3<f64> {
    Isometry3::from_parts(
        Translation3::new(floor.x, floor.y, 0.0),
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading),
    )
}

fn standing_at(floor: Vector2<f64>, heading: f64) -> Body {
    person().transformed(&on_floor(floor, heading))
}

fn percept(time: f64, body: impl Into<Option<Body>>) -> Percept {
    Percept { time, body: body.into(), action: None, surface: None }
}

fn tracker() -> BodyTracker {
    BodyTracker::new(TrackerSettings::default()).unwrap()
}

/// Gives the tracker frames `first..last` of a person whose floor position and heading are
/// functions of time.
fn watch(
    tracker: &mut BodyTracker,
    frames: std::ops::Range<u32>,
    at: impl Fn(f64) -> (Vector2<f64>, f64),
) {
    for frame in frames {
        let time = FRAME * f64::from(frame);
        let (floor, heading) = at(time);
        tracker.update(&percept(time, standing_at(floor, heading))).unwrap();
    }
}

fn assert_finite(pose: &TrackedPerson) {
    let values = [
        pose.floor.x,
        pose.floor.y,
        pose.heading,
        pose.velocity.x,
        pose.velocity.y,
        pose.heading_rate,
    ];
    assert!(values.iter().all(|value| value.is_finite()), "{pose:?}");
    assert!(!pose.age.is_nan() && !pose.heading_age.is_nan());
}

#[test]
fn a_standing_person_is_acquired_after_four_frames() {
    let mut tracker = tracker();
    watch(&mut tracker, 0..3, |_| (vector![2.0, 1.0], 0.5));
    assert_eq!(tracker.predict(0.1), None);
    watch(&mut tracker, 3..4, |_| (vector![2.0, 1.0], 0.5));
    let pose = tracker.predict(0.15).unwrap();
    assert!((pose.floor - Point2::new(2.0, 1.0)).norm() < 1e-12);
    assert!((pose.heading - 0.5).abs() < 1e-12);
    assert_eq!((pose.freshness, pose.age), (Freshness::Tracked, 0.0));
}

#[test]
fn walking_and_turning_are_followed_without_lag() {
    let velocity = vector![-0.6, 0.3];
    let mut tracker = tracker();
    watch(&mut tracker, 0..200, |t| (vector![3.0, 0.0] + velocity * t, 0.2 * t));
    let now = 199.0 * FRAME + 0.03;
    let pose = tracker.predict(now).unwrap();
    assert!((pose.floor.coords - vector![3.0, 0.0] - velocity * now).norm() < 1e-3);
    assert!((pose.velocity - velocity).norm() < 1e-3);
    assert!((pose.heading - 0.2 * now).abs() < 1e-3);
    assert!((pose.heading_rate - 0.2).abs() < 1e-3);
}

/// Returns a fixed sequence of errors with standard deviation 0.03 m and negligible correlation.
fn errors() -> impl FnMut() -> f64 {
    let mut state = 1_u32;
    move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (f64::from(state) / f64::from(u32::MAX) - 0.5) * 0.03 * 12_f64.sqrt()
    }
}

/// Each joint has independent errors. All joints of the trunk give a better velocity than mid hip
/// alone.
#[test]
fn all_trunk_joints_improve_the_velocity() {
    let error_with = |joints: &[Body25]| {
        let (mut noise, mut tracker) = (errors(), tracker());
        let (mut error, mut count) = (0.0, 0.0);
        let velocity = vector![-0.3, 0.1];
        for frame in 0..400 {
            let time = FRAME * f64::from(frame);
            let mut body = Body::default();
            for (joint, seen) in standing_at(vector![3.0, 0.2] + velocity * time, PI).iter() {
                let position = seen.position + Vector3::from_fn(|_, _| noise());
                if joints.contains(&joint) || frame < 5 {
                    body.set(joint, Some(Keypoint { position, ..seen }));
                }
            }
            tracker.update(&percept(time, body)).unwrap();
            if frame > 40 {
                let known = tracker.predict(time).unwrap();
                error += (known.velocity - velocity).norm_squared();
                count += 1.0;
                let sigma = known.velocity_covariance[(0, 0)].sqrt();
                assert!((known.velocity - velocity).amax() < 5.0 * sigma);
            }
        }
        f64::sqrt(error / count)
    };
    let alone = error_with(&[Body25::MidHip]);
    let together = error_with(&Body25::ALL);
    assert!(together < 0.85 * alone, "{together} m/s, {alone} m/s");
}

#[test]
fn filtering_reduces_noise() {
    let mut noise = errors();
    let mut tracker = tracker();
    let (mut raw, mut filtered, mut count) = (0.0, 0.0, 0.0);
    for frame in 0..400 {
        let time = FRAME * f64::from(frame);
        let truth = vector![3.0 - 0.3 * time, 0.2];
        let error = vector![noise(), noise()];
        tracker.update(&percept(time, standing_at(truth + error, PI))).unwrap();
        if frame > 20 {
            raw += error.norm_squared();
            filtered += (tracker.predict(time).unwrap().floor.coords - truth).norm_squared();
            count += 1.0;
        }
    }
    let (raw, filtered) = (f64::sqrt(raw / count), f64::sqrt(filtered / count));
    assert!(filtered < 0.8 * raw, "filtered {filtered} m, raw {raw} m");
}

#[test]
fn a_vanished_person_coasts_half_a_second() {
    let velocity = vector![0.5, 0.0];
    let mut tracker = tracker();
    watch(&mut tracker, 0..100, |t| (velocity * t, 0.0));
    let seen = 99.0 * FRAME;
    for frame in 100..160 {
        tracker.update(&percept(FRAME * f64::from(frame), None)).unwrap();
    }
    let at = |age: f64| tracker.predict(seen + age).unwrap();
    assert_eq!(at(0.1).freshness, Freshness::Tracked);
    assert_eq!(at(0.4).freshness, Freshness::Coasting);
    assert!((at(0.4).floor.x - 0.5 * (seen + 0.4)).abs() < 1e-3);
    let [uncertain, lost] = [0.6, 1.6].map(at);
    assert_eq!((uncertain.freshness, uncertain.velocity), (Freshness::Uncertain, Vector2::zeros()));
    assert_eq!((lost.freshness, lost.velocity), (Freshness::Lost, Vector2::zeros()));
    assert_eq!(lost.floor, uncertain.floor, "an unseen person stays where coasting ended");
    assert!((lost.floor.x - 0.5 * (seen + 0.5)).abs() < 1e-3);
}

#[test]
fn only_lasting_jumps_are_followed() {
    let mut tracker = tracker();
    watch(&mut tracker, 0..40, |_| (vector![2.0, 0.0], PI));
    watch(&mut tracker, 40..43, |_| (vector![2.0, 2.0], PI));
    let pose = tracker.predict(42.0 * FRAME).unwrap();
    assert!((pose.floor - Point2::new(2.0, 0.0)).norm() < 1e-9, "three frames are an outlier");
    watch(&mut tracker, 43..45, |_| (vector![2.0, 0.0], PI));
    assert_eq!(tracker.predict(44.0 * FRAME).unwrap().freshness, Freshness::Tracked);
    watch(&mut tracker, 45..49, |_| (vector![2.0, 2.0], PI));
    let pose = tracker.predict(48.0 * FRAME).unwrap();
    assert!((pose.floor - Point2::new(2.0, 2.0)).norm() < 1e-9, "four frames are a person");
}

#[test]
fn scattered_outliers_never_become_a_person() {
    let mut tracker = tracker();
    watch(&mut tracker, 0..40, |_| (vector![2.0, 0.0], PI));
    watch(&mut tracker, 40..60, |t| {
        let far = if (t / FRAME).round() % 2.0 == 0.0 { 3.0 } else { -3.0 };
        (vector![2.0, far], PI)
    });
    let pose = tracker.predict(60.0 * FRAME).unwrap();
    assert_eq!(pose.freshness, Freshness::Uncertain);
    assert!((pose.floor - Point2::new(2.0, 0.0)).norm() < 1e-6);
}

#[test]
fn a_lost_person_is_found_again_anywhere() {
    let mut tracker = tracker();
    watch(&mut tracker, 0..20, |_| (vector![2.0, 0.0], 3.0));
    watch(&mut tracker, 60..64, |_| (vector![-1.0, 4.0], -3.0));
    let pose = tracker.predict(63.0 * FRAME).unwrap();
    assert_eq!(pose.freshness, Freshness::Tracked);
    assert!((pose.floor - Point2::new(-1.0, 4.0)).norm() < 1e-9);
    assert!((pose.heading - (TAU - 3.0)).abs() < 1e-9, "the nearest branch of -3 rad to 3 rad");
}

#[test]
fn heading_takes_either_pair_and_holds_without() {
    let mut tracker = tracker();
    watch(&mut tracker, 0..20, |_| (vector![2.0, 0.0], 1.0));
    let mut show = |frames: std::ops::Range<u32>, hidden: &[Body25]| {
        for frame in frames {
            let time = FRAME * f64::from(frame);
            let mut body = standing_at(vector![2.0, 0.0], 1.0);
            for &joint in hidden {
                body.set(joint, None);
            }
            tracker.update(&percept(time, body)).unwrap();
        }
        tracker.clone()
    };
    let pose = show(20..40, &[Body25::LeftShoulder]).predict(39.0 * FRAME).unwrap();
    assert!((pose.heading - 1.0).abs() < 1e-9 && pose.heading_age == 0.0);
    let pose = show(40..60, &[Body25::RightHip]).predict(59.0 * FRAME).unwrap();
    assert!((pose.heading - 1.0).abs() < 1e-9 && pose.heading_age == 0.0);
    let pose =
        show(60..80, &[Body25::RightHip, Body25::LeftShoulder]).predict(79.0 * FRAME).unwrap();
    assert!((pose.heading - 1.0).abs() < 1e-9, "held");
    assert!((pose.heading_age - 1.0).abs() < 1e-9);
    assert_eq!((pose.freshness, pose.heading_rate), (Freshness::Tracked, 0.0));
}

#[test]
fn one_reversed_frame_does_not_turn_the_person() {
    let mut tracker = tracker();
    watch(&mut tracker, 0..40, |_| (vector![2.0, 0.0], 0.0));
    watch(&mut tracker, 40..42, |_| (vector![2.0, 0.0], PI));
    assert!(tracker.predict(41.0 * FRAME).unwrap().heading.abs() < 1e-9);
    watch(&mut tracker, 42..44, |_| (vector![2.0, 0.0], PI));
    let heading = tracker.predict(43.0 * FRAME).unwrap().heading;
    assert!((heading.abs() - PI).abs() < 1e-9, "four frames are a turn, {heading}");
}

#[test]
fn stature_comes_from_legs_and_trunk() {
    let mut tracker = tracker();
    watch(&mut tracker, 0..10, |_| (vector![2.0, 0.0], 0.0));
    assert_eq!(tracker.stature(), None);
    watch(&mut tracker, 10..40, |_| (vector![2.0, 0.0], 0.0));
    let estimate = tracker.stature().unwrap();
    // The trunk of this skeleton is 1.5 mm shorter than Drillis' and Contini's.
    assert!((estimate.stature - 1.75).abs() < 2e-3, "{estimate:?}");
    assert_eq!(estimate.frames, 40);
}

#[test]
fn wrong_time_stamps_are_refused_and_change_nothing() {
    let mut tracker = tracker();
    watch(&mut tracker, 0..10, |_| (vector![2.0, 0.0], 0.0));
    let before = tracker.predict(0.5);
    let body = || standing_at(vector![2.0, 0.1], 0.0);
    assert!(matches!(tracker.update(&percept(f64::NAN, body())), Err(Error::Value { .. })));
    let refused = tracker.update(&percept(0.45, body())).unwrap_err().to_string();
    assert!(refused.contains(&format!("0.45 s, not later than {} s", 9.0 * FRAME)), "{refused}");
    assert_eq!(tracker.predict(0.5), before);
}

/// A time stamp an hour ahead must not make the person look recent for an hour.
#[test]
fn a_future_time_stamp_means_lost() {
    let mut tracker = tracker();
    watch(&mut tracker, 0..10, |_| (vector![2.0, 0.0], 0.0));
    let seen = 9.0 * FRAME;
    assert_eq!(tracker.predict(seen - 0.1).unwrap().freshness, Freshness::Tracked);
    let pose = tracker.predict(seen - 3600.0).unwrap();
    assert_eq!((pose.freshness, pose.age), (Freshness::Lost, f64::INFINITY));
    assert!((pose.floor.x - 2.0).abs() < 1e-9 && pose.velocity.norm() == 0.0);
}

#[test]
fn earlier_frames_are_accepted_after_forgetting() {
    let mut tracker = tracker();
    watch(&mut tracker, 100..140, |_| (vector![2.0, 0.0], 0.0));
    let stature = tracker.stature();
    tracker.forget();
    assert_eq!(tracker.predict(140.0 * FRAME), None);
    watch(&mut tracker, 0..10, |_| (vector![1.0, 0.0], 0.0));
    assert!((tracker.predict(9.0 * FRAME).unwrap().floor.x - 1.0).abs() < 1e-9);
    assert!(stature.is_some() && tracker.stature().is_some());
}

#[test]
fn wrong_settings_are_refused_by_name() {
    let base = TrackerSettings::default;
    for (name, settings) in [
        ("least_confidence", TrackerSettings { least_confidence: 1.5, ..base() }),
        ("position_sigma", TrackerSettings { position_sigma: 0.0, ..base() }),
        ("heading_sigma", TrackerSettings { heading_sigma: f64::NAN, ..base() }),
    ] {
        match BodyTracker::new(settings) {
            Err(Error::Value { what, .. }) => assert_eq!(what, name),
            other => panic!("{name}: {other:?}"),
        }
    }
}

/// Generates coordinates from cameras, files and bugs.
fn any_coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -5.0..5.0_f64,
        1 => prop_oneof![Just(f64::NAN), Just(f64::INFINITY), Just(f64::MAX), Just(-f64::MAX)],
        1 => any::<f64>(),
    ]
}

fn any_body() -> impl Strategy<Value = Body> {
    let joint = prop::option::weighted(
        0.8,
        (any_coordinate(), any_coordinate(), any_coordinate(), 0.0..=1.0_f64).prop_map(
            |(x, y, z, confidence)| Keypoint {
                position: Point3::new(x, y, z),
                confidence: Confidence::new(confidence).unwrap(),
            },
        ),
    );
    prop::collection::vec(joint, 25).prop_map(|joints| Body::new(joints.try_into().unwrap()))
}

/// Generates a walking person with a constant velocity and turning rate in each half second.
fn any_walk() -> impl Strategy<Value = Vec<(Vector2<f64>, f64)>> {
    let leg = (-1.0..1.0_f64, -1.0..1.0_f64, -2.0..2.0_f64);
    (prop::collection::vec(leg, 1..12), -PI..PI).prop_map(|(legs, heading)| {
        let mut pose = (vector![1.5, 0.0], heading);
        legs.into_iter()
            .flat_map(|leg| std::iter::repeat_n(leg, 10))
            .map(|(vx, vy, rate)| {
                pose = (pose.0 + vector![vx, vy] * FRAME, pose.1 + rate * FRAME);
                pose
            })
            .collect()
    })
}

proptest! {
    #[test]
    fn never_nan_whatever_the_input(
        frames in prop::collection::vec((prop::option::weighted(0.9, any_body()), 1e-3..0.4_f64), 1..30),
        real_people in prop::collection::vec(any::<bool>(), 30),
        now in any::<f64>(),
    ) {
        let mut tracker = tracker();
        let mut time = 0.0;
        for ((body, step), real) in frames.into_iter().zip(real_people) {
            time += step;
            let body = if real { Some(standing_at(vector![1.0, 0.5], 3.0)) } else { body };
            tracker.update(&percept(time, body)).unwrap();
            for at in [time, time + 0.3, time + 10.0, now, f64::NAN, f64::INFINITY, -f64::MAX] {
                if let Some(pose) = tracker.predict(at) {
                    assert_finite(&pose);
                }
            }
        }
    }

    #[test]
    fn coasting_is_bounded(walk in any_walk(), after in 0.0..1e6_f64) {
        let mut tracker = tracker();
        for (frame, &(floor, heading)) in (0..).zip(&walk) {
            tracker.update(&percept(FRAME * f64::from(frame), standing_at(floor, heading))).unwrap();
        }
        let last = FRAME * (walk.len() - 1) as f64;
        let (seen, later) = (tracker.predict(last).unwrap(), tracker.predict(last + after).unwrap());
        let reach = 3.0 * Freshness::COASTING;
        prop_assert!((later.floor - seen.floor).norm() <= reach + 1e-9);
        prop_assert!(
            (later.heading - seen.heading).abs()
                <= 4.0 * 0.1 + 1e-9
        );
        prop_assert_eq!(later.freshness.is_usable(), later.age <= Freshness::COASTING);
    }

    /// A motion of the whole world moves the pose with it.
    #[test]
    fn tracking_is_invariant_to_where_the_world_is(
        walk in any_walk(), x in -10.0..10.0_f64, y in -10.0..10.0_f64, turn in -PI..PI,
    ) {
        let motion = on_floor(vector![x, y], turn);
        let (mut here, mut there) = (tracker(), tracker());
        let mut branch = None;
        for (frame, &(floor, heading)) in (0..).zip(&walk) {
            let time = FRAME * f64::from(frame);
            let body = standing_at(floor, heading);
            there.update(&percept(time, body.transformed(&motion))).unwrap();
            here.update(&percept(time, body)).unwrap();
            let now = time + 0.02;
            prop_assert_eq!(here.predict(now).is_some(), there.predict(now).is_some());
            if let (Some(here), Some(there)) = (here.predict(now), there.predict(now)) {
                let moved = motion * Point3::new(here.floor.x, here.floor.y, 0.0);
                prop_assert!((there.floor - moved.xy()).norm() < 1e-9);
                let turned = motion.rotation * here.velocity.push(0.0);
                prop_assert!((there.velocity - turned.xy()).norm() < 1e-9);
                // Equal up to a constant whole number of turns.
                let turns = (there.heading - here.heading - turn) / TAU;
                prop_assert!((turns - turns.round()).abs() < 1e-9);
                prop_assert!((turns - *branch.get_or_insert(turns)).abs() < 1e-9);
                prop_assert_eq!(here.freshness, there.freshness);
            }
        }
    }

    /// The heading is continuous from frame to frame, however often the person turns around.
    #[test]
    fn heading_is_continuous_through_half_turns(rate in -2.5..2.5_f64, start in -PI..PI) {
        let mut tracker = tracker();
        let mut before: Option<(f64, f64)> = None;
        for frame in 0..200 {
            let time = FRAME * f64::from(frame);
            let truth = start + rate * time;
            tracker.update(&percept(time, standing_at(vector![1.0, 1.0], truth))).unwrap();
            let Some(pose) = tracker.predict(time) else { continue };
            if let Some((heading, offset)) = before {
                prop_assert!((pose.heading - heading).abs() < 0.6);
                prop_assert!((pose.heading - truth - offset).abs() < 0.6, "no turn is lost");
            }
            let offset = before.map_or(((pose.heading - truth) / TAU).round() * TAU, |(_, o)| o);
            before = Some((pose.heading, offset));
        }
        let (heading, offset) = before.unwrap();
        // A person who turns slowly may seem to stand for a moment.
        let tolerance = if rate.abs() < 0.25 { 0.1 } else { 0.02 };
        prop_assert!((heading - offset - (start + rate * 199.0 * FRAME)).abs() < tolerance);
    }
}

/// A detector that changes between two people teaches the tracker no noise.
#[test]
fn another_person_in_every_other_frame_is_ignored() {
    let mut tracker = tracker();
    let (own, other) = (vector![1.5, 0.0], vector![1.5, 1.0]);
    watch(&mut tracker, 0..20, |_| (own, PI));
    let is_own = |time: f64| (0.5 * time / FRAME + 0.1).fract() < 0.5;
    watch(&mut tracker, 20..220, |time| (if is_own(time) { own } else { other }, PI));
    let off = (tracker.predict(219.0 * FRAME).unwrap().floor.coords - own).norm();
    assert!(off < 0.05, "{off} m");
}
