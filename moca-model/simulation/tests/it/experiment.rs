//! The paper's experiments, in a few small cases.

use std::ops::ControlFlow;

use moca_model::{ControllerSettings, Goal, moca_safety};
use moca_replay::report::TickRow;
use moca_simulation::experiment::reorientation::ReorientationResult;
use moca_simulation::experiment::{
    Conditions, DistanceError, DistanceMonitor, FollowingDistance, Player, Sight, Spread, Versus,
    Walk, following, reorientation, subjects,
};
use moca_simulation::people::{Truth, WalkerSettings};
use moca_simulation::plant::Drive;
use moca_simulation::run::{Run, TrueMotion};
use nalgebra::{Point2, Vector2, Vector3};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use vision_models::{Action, Body25};

use crate::support::average_map;

fn player() -> Player<'static> {
    Player::new(&|| ControlFlow::Continue(()))
}

const KINEMATIC: Conditions =
    Conditions { drive: Drive::Kinematic, sight: Sight::Modelled, paper: false };

#[test]
fn cases_do_not_depend_on_their_number() {
    let walkers = |seed, count| -> Vec<_> {
        following::cases(seed, count, 30.0).into_iter().map(|case| case.person).collect()
    };
    assert_eq!(walkers(3, 5)[..2], walkers(3, 2)[..]);
    assert_ne!(walkers(3, 2), walkers(4, 2));
    let (few, more) = (reorientation::cases(3, 2), reorientation::cases(3, 5));
    for (few, more) in few.iter().zip(&more) {
        assert_eq!((few.number, few.front, &few.person), (more.number, more.front, &more.person));
    }
    // There are ten people, each with the same number of cases.
    let of = |subject| {
        subjects::cases(1, 21, 30.0).iter().filter(|case| case.subject == subject).count()
    };
    assert!((0..10).all(|subject| of(subject) == 3));
}

/// The object is handed over, the camera identifies the surfaces, and the robot turns it to the one for the person's
/// tool. In the first case the robot's belief is right, then it is wrong.
#[test]
fn the_right_surface_comes_before_the_person() {
    let cases = reorientation::cases(1, 8);
    let other = cases.iter().find(|case| case.front != cases[0].front).unwrap();
    let trials =
        [&cases[0], other].map(|case| case.play(average_map(), KINEMATIC, &mut player()).unwrap());
    let result = ReorientationResult::new(trials.into());
    let (on, off) = (&result.turns_on, &result.turns_off);
    assert_eq!(
        (on.cases, on.grasped, on.recognised, on.right, on.safe),
        (2, 2, 2, 2, 2),
        "{result}"
    );
    // The benchmark may hold the object so that the camera sees neither side, and then cannot identify them.
    assert_eq!((off.cases, off.grasped), (2, 2), "{result}");
    assert!(off.recognised >= 1, "{result}");
    assert_eq!((off.right, off.safe), (off.recognised, off.recognised), "{result}");
    let text = result.to_string();
    assert!(text.contains("Handover -> Grasping: Arrived"), "{text}");
    assert!(text.contains("Turning { to: Back }: WrongSurface"), "{text}");
    assert!(text.contains("-> Working: RightSurface"), "{text}");
}

#[test]
fn the_same_case_twice_gives_the_same_bits() {
    let case = &following::cases(5, 1, 8.0)[0];
    let play = || {
        let [on, off] = case.play(average_map(), KINEMATIC, &mut player()).unwrap();
        [on.score_mean, on.outside, on.tracking_error_rms_mm, off.score_mean].map(f64::to_bits)
    };
    assert_eq!(play(), play());
}

/// A person walks at 0.5 m/s, and the hand is 0.1 m behind its usual place, which it reached while they stood. All of
/// this is an error without separation. Otherwise the part is allowed that the protective distance needs for a person
/// who is seen T_r late.
#[test]
fn a_hand_that_lags_is_a_steady_error() {
    let on = ControllerSettings::default();
    let off = ControllerSettings { safety: moca_safety().off(), ..on.clone() };
    let outward = (on.space.min + on.space.max).xy().normalize();
    // The clearance is 0.4 m; T_r = 0.15 s, a = 0.5 m/s², C + Z_d + Z_r = 0.11 m.
    let away = 0.5 * outward.x;
    let asked = outward * (2.0 * 0.15 * away + away * away + 0.11 - 0.4);
    let rest = (Vector2::new(0.1, 0.0) - asked).norm();
    for (settings, steady) in [(on, rest), (off, 0.1)] {
        let error = lagging(FollowingDistance::new(&settings));
        assert!((error.steady.unwrap() - steady).abs() < 1e-3, "{error:?}, not {steady}");
        assert!((error.behind.unwrap() - 0.1).abs() < 1e-3, "{error:?}");
        assert!((error.largest - 0.1).abs() < 0.03, "{error:?}");
    }
}

/// The error of a hand that lags so, for this following distance.
fn lagging(following: Option<FollowingDistance>) -> DistanceError {
    let speed = |time: f64| if time < 5.0 { 0.0 } else { 0.5 };
    let floor = |time: f64| Vector2::new(-0.5 * (time - 5.0).max(0.0), 1.0);
    let truth: Vec<Truth> = (0..200_u32)
        .map(|frame| {
            let time = 0.05 * f64::from(frame);
            Truth {
                time,
                floor: Point2::from(floor(time)),
                heading: 0.0,
                velocity: Vector2::new(-speed(time), 0.0),
                action: Action::Walking,
            }
        })
        .collect();
    let mut monitor = DistanceMonitor::new(&truth, following);
    for tick in 0..9900_u32 {
        let time = 1e-3 * f64::from(tick);
        let (coming, lag) = (0.2 * (3.0 - time).max(0.0), 0.2 * speed(time));
        let hand = floor(time) + Vector2::new(0.4 + coming + lag, -0.1);
        let actual = [hand.x, hand.y, 1.0];
        monitor.push(&TickRow { time, actual, collaborating: true, ..TickRow::default() });
    }
    monitor.error()
}

/// A filmed person is seen in the right place and with the right action. The joints differ from those of the camera
/// model.
#[test]
fn pixels_show_the_person_where_they_are() {
    let settings = WalkerSettings { stature: 1.68, duration: 8.0, seed: 7, ..Default::default() };
    let seen = Walk::new(settings.clone(), Sight::Pixels).unwrap();
    let modelled = Walk::new(settings, Sight::Modelled).unwrap();
    assert_eq!(seen.truth, modelled.truth);
    assert_eq!(seen.percepts.len(), modelled.percepts.len());
    let (mut squared, mut count, mut bodies, mut the_same) = (0.0, 0_u32, 0, 0);
    for (percept, reported) in seen.percepts.iter().zip(&modelled.percepts) {
        assert_eq!((percept.time, percept.action), (reported.time, reported.action));
        let Some(body) = &percept.body else { continue };
        bodies += 1;
        the_same += u32::from(percept.body == reported.body);
        // The object hides it at times.
        let Some(pelvis) = body.get(Body25::MidHip) else { continue };
        let truth = seen.truth.iter().find(|truth| truth.time == percept.time).unwrap();
        squared += (pelvis.position.xy() - truth.floor).norm_squared();
        count += 1;
    }
    let frames = seen.percepts.len();
    assert!(bodies > frames * 9 / 10, "seen in {bodies} of {frames} frames");
    assert!(count > 40, "the pelvis in {count} of {frames} frames");
    assert_eq!(the_same, 0);
    let error = (squared / f64::from(count)).sqrt();
    assert!(error < 0.05, "the pelvis is {error} m from where it is");
}

/// The true person judges distances, not the seen one.
#[test]
fn approaching_the_true_person_too_near_counts() {
    let settings = WalkerSettings { duration: 14.0, offer: 0.0, ..Default::default() };
    let walk = Walk::new(settings, Sight::Modelled).unwrap();
    let too_near = |nearer: f64| {
        let mut draw = ChaCha8Rng::seed_from_u64(1);
        let mut scenario = walk.scenario(average_map(), KINEMATIC, &mut draw).unwrap();
        let (seen, mut truth) = (scenario.truth.take().unwrap(), TrueMotion::default());
        for time in walk.truth.iter().map(|truth| truth.time) {
            let joints = seen.at(time).unwrap();
            truth.push(time, joints.map(|joint| joint - Vector3::x() * nearer));
        }
        scenario.truth = Some(truth);
        let run = Run::new(&scenario, Goal::Ergonomics).unwrap();
        run.play(|_, _| ControlFlow::Continue(())).unwrap().separation_violations
    };
    assert_eq!(too_near(0.0), 0);
    assert!(too_near(0.5) > 100);
}

#[test]
fn nothing_played_is_no_number() {
    assert!(Spread::of([]).mean.is_nan() && Spread::of([]).worst.is_nan());
    let line = serde_json::to_value(Versus::default().line()).unwrap();
    assert_eq!((&line["cases"], &line["score"]["wins"]), (&0.into(), &serde_json::Value::Null));
}
