//! The states of the supervisor, as in the book's table.

use hrsw_safety::{Cause, SafetyState};
use moca_model::moca_safety;
use nalgebra::{Point3, Vector3};
use vision_models::{Body25, Confidence, Keypoint};

use crate::drive::{Drive, FRAME, percept};

/// The rows of the book's table: state, when it ends.
fn table() -> Vec<[String; 2]> {
    let book = include_str!("../book.md");
    let header = "| state | cause | entered when | what the robot does | left when |";
    let (_, table) = book.split_once(header).unwrap();
    let rows = table.lines().skip(2).take_while(|line| line.starts_with('|'));
    rows.map(|line| {
        let cells: Vec<_> = line.trim_matches('|').split('|').map(str::trim).collect();
        [cells[0].to_owned(), cells[4].to_owned()]
    })
    .collect()
}

/// The largest share of its speed limit that a joint uses.
fn share(drive: &Drive) -> f64 {
    let limits = drive.controller.robot().model().limits();
    let shares = drive.velocity.iter().zip(limits).map(|(v, limits)| v.abs() / limits.velocity);
    shares.fold(0.0, f64::max)
}

#[test]
fn every_state_is_as_in_the_book() {
    let states: Vec<_> = table().into_iter().map(|[state, _]| state).collect();
    assert_eq!(states, ["normal", "reduced", "retreat", "protective stop"]);
    let settings = moca_safety().supervisor;
    for [state, left] in table() {
        let mut drive = Drive::fast();
        match state.as_str() {
            "normal" => {
                drive.run(0.1);
                assert_eq!(drive.state(), SafetyState::Normal);
                assert!(left.is_empty());
            }
            "reduced" | "protective stop" => {
                let (after, expected) = match state.as_str() {
                    "reduced" => (settings.reduced_age, SafetyState::Reduced),
                    _ => (settings.stop_age, SafetyState::ProtectiveStop),
                };
                drive.camera = false;
                while drive.state() < expected {
                    drive.step();
                }
                let cause = drive.controller.safety().supervisor().cause();
                let Some(Cause::Stale { age }) = cause else { panic!("{cause:?}") };
                assert!((age.seconds() - after).abs() < 0.002 + 0.05, "{age:?}");
                if expected == SafetyState::ProtectiveStop {
                    drive.run(2.0);
                    assert!(drive.fastest() < 1e-9);
                } else {
                    drive.run(0.4);
                    assert!(share(&drive) <= 0.5 + 1e-9);
                }
                drive.camera = true;
                drive.run(2.0);
                assert_eq!(drive.state(), SafetyState::Normal, "{left}");
            }
            "retreat" => {
                // A person suddenly stands in front of the robot.
                drive.person = Some(drive.controller.actual().translation.x + 0.75);
                while drive.state() < SafetyState::Retreat {
                    drive.step();
                }
                let cause = drive.controller.safety().supervisor().cause();
                assert!(matches!(cause, Some(Cause::TooClose(_))), "{cause:?}");
                assert_eq!(drive.state(), SafetyState::Retreat);
                // The ramp, and the time that the joints need to slow down.
                drive.run(1.5);
                let (mut last, mut nearest) = (drive.distance(), 0.0_f64);
                while drive.state() == SafetyState::Retreat {
                    drive.step();
                    assert!(share(&drive) <= 0.15 + 1e-9, "{:?}", drive.velocity);
                    nearest = nearest.min(drive.distance() - last);
                    last = drive.distance();
                    if drive.time() > 20.0 {
                        break;
                    }
                }
                assert!(nearest > -1e-5, "it comes no nearer: {nearest} m in a tick");
                drive.person = Some(drive.controller.actual().translation.x + 5.0);
                drive.run(1.5);
                assert_eq!(drive.state(), SafetyState::Normal, "{left}");
            }
            other => panic!("{other} is no state"),
        }
    }
}

/// Frames with the person at another place each time do not tell where they are.
#[test]
fn a_person_who_is_everywhere_is_no_news() {
    let settings = moca_safety().supervisor;
    let mut drive = Drive::fast();
    drive.person = Some(drive.controller.actual().translation.x + 5.0);
    drive.run(0.5);
    assert_eq!(drive.state(), SafetyState::Normal);
    let began = drive.time();
    let mut entered = [None; 2];
    for tick in 0..1200_u32 {
        // The place changes between two frames.
        let frame = (tick + FRAME / 2) / FRAME;
        let away = f64::from(10 + 7 * (frame % 5));
        drive.person = Some(drive.controller.actual().translation.x + away);
        drive.step();
        for (entered, state) in
            entered.iter_mut().zip([SafetyState::Reduced, SafetyState::ProtectiveStop])
        {
            if drive.state() >= state {
                entered.get_or_insert(drive.time() - began);
            }
        }
    }
    let [Some(reduced), Some(stopped)] = entered else { panic!("{entered:?}") };
    // No person is that fast, so that the first of these frames is a fault.
    assert!(reduced < 0.11, "{reduced} s");
    assert!((stopped - settings.stop_age).abs() < 0.11, "{stopped} s");
    // A person who did move there is accepted.
    drive.run(2.0);
    assert_eq!(drive.state(), SafetyState::Normal);
}

/// A person who is seen in one frame at an unreachable place counts there and at the last place.
#[test]
fn single_frame_counts_at_both_places() {
    let mut drive = Drive::fast();
    let here = drive.controller.actual().translation.x + 3.0;
    drive.person = Some(here);
    drive.run(0.5);
    let counts_at = |drive: &Drive, x: f64| {
        let chest = Vector3::new(x, 0.0, 1.2);
        let bodies = drive.controller.safety().person_bodies();
        bodies.iter().any(|body| body.capsule.signed_distance(&chest) < 0.1)
    };
    assert!(counts_at(&drive, here) && !counts_at(&drive, here + 9.0));
    drive.person = Some(here + 9.0);
    while !counts_at(&drive, here + 9.0) {
        drive.step();
    }
    assert!(counts_at(&drive, here));
    // Frames without people decide nothing.
    let mut left = drive.clone();
    left.person = None;
    left.run(0.3);
    assert!(counts_at(&left, here + 9.0) && counts_at(&left, here));
    // The next sighting decides.
    drive.run(0.06);
    assert!(counts_at(&drive, here + 9.0) && !counts_at(&drive, here));
}

/// Place of a person, about five metres in front of the robot \[m\].
const AHEAD: f64 = 5.5;

/// Shows `joints` of a person for half a second, and hips and shoulders for five. From half a second on, `check` gets
/// the tick and a function that returns the distance of a point from the bodies.
fn hide(joints: &[(Body25, Point3<f64>)], check: impl Fn(u32, &dyn Fn(&Vector3<f64>) -> f64)) {
    let mut drive = Drive::fast();
    for tick in 0..5000_u32 {
        if tick.is_multiple_of(FRAME) {
            let mut percept = percept(drive.time(), Some(AHEAD));
            let body = percept.body.as_mut().unwrap();
            for &(joint, position) in joints.iter().filter(|_| tick < 500) {
                body.set(joint, Some(Keypoint { position, confidence: Confidence::ONE }));
            }
            drive.controller.observe(&percept).unwrap();
        }
        let position = drive.robot.position().to_vec();
        drive.controller.step(drive.time(), &position).unwrap();
        drive.tick += 1;
        if tick >= 500 {
            let bodies = drive.controller.safety().person_bodies();
            let distances = |point: &Vector3<f64>| {
                let distances = bodies.iter().map(|body| body.capsule.signed_distance(point));
                distances.fold(f64::MAX, f64::min)
            };
            check(tick, &distances);
        }
    }
}

/// A wrist that is not seen for long may be anywhere within reach of the shoulder. All those places count, and no
/// others.
#[test]
fn hidden_wrist_stays_within_reach_of_shoulder() {
    let shoulder = Point3::new(AHEAD, 0.2, 1.43);
    let at = |z: f64| Point3::new(AHEAD, 0.2, z);
    let arm = [(Body25::RightElbow, at(1.13)), (Body25::RightWrist, at(0.88))];
    hide(&arm, |tick, nearest| {
        for toward in [Vector3::x(), -Vector3::x(), Vector3::y(), Vector3::z()] {
            // The arm hung down when it was last seen, and is raised at 1.6 m/s at most.
            for along in [0.2, 0.4, 0.6] {
                let place = shoulder.coords + toward * along;
                assert!(tick < 1500 || nearest(&place) < 0.0, "tick {tick}: {toward:?} {along}");
            }
            let beyond = shoulder.coords + toward * 1.45;
            assert!(nearest(&beyond) > 0.0, "tick {tick}: {toward:?}");
        }
    });
}

/// Hidden legs stand, walk or sit. Their feet are within a step of the hips, and they do not keep the robot from the
/// hands.
#[test]
fn legs_that_are_not_seen_stay_below() {
    let at = |z: f64| Point3::new(AHEAD, 0.12, z);
    let leg = [(Body25::RightKnee, at(0.5)), (Body25::RightAnkle, at(0.1))];
    hide(&leg, |tick, nearest| {
        for toward in [Vector3::x(), -Vector3::x(), Vector3::y()] {
            for (aside, height) in [(0.25, 0.1), (0.45, 0.1), (0.45, 0.4)] {
                let foot = at(height).coords + toward * aside;
                // Legs move with the standing person, and also with the uncertainty of the person's velocity.
                assert!(tick < 4500 || nearest(&foot) < 0.0, "tick {tick}: {toward:?} {aside}");
            }
            let hand = at(1.1).coords + toward * 0.75;
            assert!(nearest(&hand) > 0.05, "tick {tick}: {toward:?}");
        }
    });
}
