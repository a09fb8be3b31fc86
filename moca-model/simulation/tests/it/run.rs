//! Runs on the shipped recording and on random ones.

use std::{ops::ControlFlow, sync::LazyLock};

use ergo_map::Person;
use moca_model::Goal;
use moca_simulation::people::Walker;
use moca_simulation::run::{Run, Scenario, Summary};
use nalgebra::Vector3;
use vision_models::{Body, Body25, Confidence, Keypoint, PersonId};

use crate::support::{average_map, cases, recorded};

/// Length of a piece of a random recording of 15 s \[s\].
const PIECE: f64 = 3.0;

fn play(scenario: &Scenario, goal: Goal) -> Summary {
    let mut last = 0.0;
    Run::new(scenario, goal)
        .unwrap()
        .play(|row, _| {
            let numbers = row.q.iter().chain(&row.qdot).chain(&row.desired).chain(&row.slack);
            assert!(numbers.chain([&row.score]).all(|value| value.is_finite()), "{row:?}");
            last = row.time;
            ControlFlow::Continue(())
        })
        .unwrap()
}

fn assert_sound(summary: &Summary, what: &str) {
    assert_eq!(summary.limit_violations, 0, "{what}: {:?}", summary.margins);
    assert_eq!(summary.solver_failures, 0, "{what}");
    assert!(summary.torque_violations.is_none_or(|violations| violations == 0), "{what}");
}

fn assert_sound_and_worth_it(scenario: &Scenario) -> [Summary; 2] {
    let on = play(scenario, Goal::Ergonomics);
    let off = play(scenario, Goal::LeastMotion);
    assert_sound(&on, "on");
    assert_sound(&off, "off");
    assert!(on.together > 30.0 && off.together > 30.0, "{} s, {} s", on.together, off.together);
    assert!(on.score_mean <= 0.3, "e_s with ergonomics: {}", on.score_mean);
    assert!(off.score_mean >= 3.0 * on.score_mean, "{} {}", off.score_mean, on.score_mean);
    // Both runs begin to work together in the same place, which may be the worst.
    assert!(off.reba_max >= on.reba_max, "{} {}", off.reba_max, on.reba_max);
    assert!(off.reba_mean >= 2.0 * on.reba_mean, "{} {}", off.reba_mean, on.reba_mean);
    assert_eq!((on.protective_stops, on.torque_violations), (0, Some(0)));
    [on, off]
}

fn shipped() -> Scenario {
    Scenario::new(recorded(), &Person::average(), average_map().clone()).unwrap()
}

/// The settings are as shipped: protective distances and torques. The desired pose moves along with a robot that
/// stands, so that it is outside the shared workspace for a while.
#[test]
fn ergonomics_pay_on_the_shipped_recording() {
    let scenario = shipped();
    assert!(scenario.has_separation());
    let [on, off] = assert_sound_and_worth_it(&scenario);
    assert!(on.outside <= 0.15 * on.together, "outside for {} s of {}", on.outside, on.together);
    assert_eq!((on.separation_violations, off.separation_violations), (0, 0));
    assert_eq!(off.protective_stops, 0);
}

/// Another person stands where the robot begins to follow the person to. The robot also keeps away from them, and more
/// people than it has room for stop it.
#[test]
fn others_in_a_recording_are_kept_away_from() {
    let mut scenario = shipped();
    scenario.percepts.truncate(300);
    scenario.arrivals.truncate(300);
    let alone = play(&scenario, Goal::Ergonomics);
    assert!(alone.together > 3.0);
    let first = scenario.percepts.iter().find_map(|percept| percept.body.as_ref()).unwrap();
    let pelvis = first.get(Body25::MidHip).unwrap().position;
    let standing_at = |x: f64, y: f64| {
        let mut body = Body::default();
        for (joint, seen) in first.iter() {
            let place = seen.position - pelvis + Vector3::new(x, y, pelvis.z);
            body.set(joint, Some(Keypoint { position: place.into(), confidence: Confidence::ONE }));
        }
        body
    };
    let among = |bodies: &[Body]| {
        let bodies: Vec<_> =
            (1..).zip(bodies).map(|(id, body)| body.clone().with_id(PersonId::new(id))).collect();
        let scenario = Scenario { percepts: scenario.percepts.clone(), ..shipped() };
        let others = vec![bodies; scenario.percepts.len()];
        play(&scenario.among(others).unwrap(), Goal::Ergonomics)
    };
    let beside = among(&[standing_at(0.7, 0.7)]);
    assert_sound(&beside, "somebody beside the tool");
    assert_eq!(beside.separation_violations, 0);
    // A standing person is measured to stand. The robot still comes, and hardly sooner.
    assert!(beside.outside >= alone.outside - 0.1, "{} {}", beside.outside, alone.outside);
    assert!(beside.together <= alone.together + 0.1, "{} {}", beside.together, alone.together);
    // The person is one of the others until they engage.
    let work = scenario
        .percepts
        .iter()
        .position(|percept| percept.action.is_some_and(|seen| seen.action.is_collaborative()));
    let (mut late, mut others) = (scenario.percepts.clone(), vec![Vec::new(); 300]);
    for (percept, others) in late.iter_mut().zip(&mut others).take(work.unwrap()) {
        others.extend(percept.body.take());
    }
    // An old recording has no ids.
    let bare = |body: &Body| body.clone().with_id(None);
    let old = late.iter().cloned().map(|mut percept| {
        percept.body = percept.body.as_ref().map(bare);
        percept
    });
    let (old, of_old) =
        (old.collect(), others.iter().map(|bodies| bodies.iter().map(bare).collect()));
    for (percepts, others) in [(old, of_old.collect()), (late, others)] {
        let late = Scenario { percepts, ..shipped() }.among(others).unwrap();
        let frames = late.scenes();
        assert_eq!((frames[0].others(), &frames[0].percept), (late.others(0), &late.percepts[0]));
        let late = play(&late, Goal::Ergonomics);
        assert_sound(&late, "the person is one of the others at first");
        assert_eq!(late.separation_violations, 0);
        assert!(late.together > 0.8 * alone.together, "{} {}", late.together, alone.together);
    }
    let crowd: Vec<_> = (0..5).map(|place| standing_at(-6.0, f64::from(place))).collect();
    let (four, five) = (among(&crowd[..4]), among(&crowd));
    assert_eq!((four.protective_stops, five.protective_stops), (0, 1));
    assert_eq!((four.together, four.retreats), (alone.together, alone.retreats));
}

#[test]
fn ergonomics_pay_without_separation() {
    let [on, off] = assert_sound_and_worth_it(&shipped().without_separation());
    // A working person pushes a tool of some 2 N/mm with 20 N, at the end of a drill of 0.2 m.
    assert!(on.tracking_error_rms_mm < 15.0, "{} mm", on.tracking_error_rms_mm);
    // Both keep within the shared workspace except for its fastest motions.
    assert!(on.outside < 0.1 * on.together && off.outside < 0.2 * off.together);
}

/// Each random recording contributes another piece. There are noise, dropped joints, vanishing people and jumps of two
/// metres, with people from 1.5 to 2 m. Set the number of recordings with `AHQP_CASES=500 cargo test --release -p
/// moca-simulation --test it run::`.
fn assert_sound_on_random_recordings(goal: Goal) {
    static SCENARIOS: LazyLock<Vec<Scenario>> =
        LazyLock::new(|| (0..cases(10)).map(random_scenario).collect());
    for (seed, scenario) in SCENARIOS.iter().enumerate() {
        assert_sound(&play(scenario, goal), &format!("seed {seed}"));
    }
}

fn random_scenario(seed: u64) -> Scenario {
    let walker = Walker::random(seed);
    let person = Person::new(walker.settings().stature).unwrap();
    let map = average_map().for_stature(person.stature()).unwrap();
    let begin = (seed % 5) as f64 * PIECE;
    let piece = walker.filter(|percept| (begin..=begin + PIECE).contains(&percept.time));
    let scenario = Scenario::new(piece.collect(), &person, map).unwrap();
    if seed.is_multiple_of(2) { scenario.without_separation() } else { scenario }
}

#[test]
fn random_recordings_keep_all_limits() {
    assert_sound_on_random_recordings(Goal::Ergonomics);
}

#[test]
fn random_recordings_keep_limits_without_ergonomics() {
    assert_sound_on_random_recordings(Goal::LeastMotion);
}

/// Joints that start outside their limits return without a failure on the way.
#[test]
fn joints_return_from_outside_their_limits() {
    let mut scenario =
        Scenario::new(Walker::random(7).collect(), &Person::average(), average_map().clone())
            .unwrap()
            .kinematic();
    scenario.start[4] = 1.9; // the second joint of the arm ends at 1.7628 rad
    scenario.start[6] = 0.1; // the fourth at -0.0698 rad
    let mut last = Vec::new();
    let summary = Run::new(&scenario, Goal::Ergonomics)
        .unwrap()
        .play(|row, _| {
            last.clone_from(&row.q);
            ControlFlow::Continue(())
        })
        .unwrap();
    assert_sound(&summary, "outside");
    for (q, limits) in last.iter().zip(scenario.model.limits()) {
        assert!((limits.lower - 1e-9..=limits.upper + 1e-9).contains(q), "{q} {limits:?}");
    }
}
