//! The main job end to end: the loop of `follow` on the shipped recording and on random ones.

use std::thread;

use ergo_map::{ErgonomicsMap, MapOptions, Person};
use examples::follow::{Run, Scenario, Summary};
use examples::recording;
use examples::simulation::Walker;
use moca_model::Goal;
use vision_models::Percept;

fn map() -> ErgonomicsMap {
    ErgonomicsMap::build(&Person::average(), &MapOptions::default(), None).unwrap()
}

fn play(scenario: &Scenario, goal: Goal) -> Summary {
    let mut last = 0.0;
    Run::new(scenario, goal)
        .unwrap()
        .play(|row| {
            let numbers = row.q.iter().chain(&row.qdot).chain(&row.desired).chain(&row.slack);
            assert!(numbers.chain([&row.score]).all(|value| value.is_finite()), "{row:?}");
            last = row.time;
            Ok(())
        })
        .unwrap()
}

fn assert_sound(summary: &Summary, what: &str) {
    assert_eq!(summary.limit_violations, 0, "{what}: {:?}", summary.margins);
    assert_eq!(summary.solver_failures, 0, "{what}");
}

#[test]
fn ergonomics_pay_on_the_shipped_recording() {
    let percepts: Vec<Percept> = recording::shipped().unwrap().map(Result::unwrap).collect();
    let scenario = Scenario::new(percepts, &Person::average(), map()).unwrap();
    let on = play(&scenario, Goal::Ergonomics);
    let off = play(&scenario, Goal::LeastMotion);
    assert_sound(&on, "on");
    assert_sound(&off, "off");
    assert!(on.together > 30.0 && off.together > 30.0, "{} s, {} s", on.together, off.together);
    assert!(on.score_mean <= 0.35, "e_s with ergonomics: {}", on.score_mean);
    assert!(off.score_mean >= 3.0 * on.score_mean, "{} {}", off.score_mean, on.score_mean);
    assert!(off.reba_max > on.reba_max);
    assert!(on.tracking_error_rms_mm < 1.0, "{} mm", on.tracking_error_rms_mm);
    // Both keep to the shared workspace but for its fastest moves.
    assert!(on.outside < 0.1 * on.together && off.outside < 0.2 * off.together);
}

/// With protective distances the robot stands more often, and the ergonomics pay still. The desired
/// pose goes along with a robot that stands, so that it is outside the shared workspace for a while;
/// for more than half of the time of working together it is within.
#[test]
fn ergonomics_pay_at_protective_distances() {
    let percepts: Vec<Percept> = recording::shipped().unwrap().map(Result::unwrap).collect();
    let scenario = Scenario::new(percepts, &Person::average(), map()).unwrap().with_separation();
    let on = play(&scenario, Goal::Ergonomics);
    let off = play(&scenario, Goal::LeastMotion);
    assert_sound(&on, "on");
    assert_sound(&off, "off");
    assert!(on.together > 30.0 && off.together > 30.0, "{} s, {} s", on.together, off.together);
    assert!(on.score_mean <= 0.35, "e_s with ergonomics: {}", on.score_mean);
    assert!(off.score_mean >= 3.0 * on.score_mean, "{} {}", off.score_mean, on.score_mean);
    assert!(on.outside < 0.45 * on.together, "outside for {} s of {}", on.outside, on.together);
    assert!(off.outside < 0.35 * off.together, "outside for {} s of {}", off.outside, off.together);
}

/// Noise, dropped joints, vanishing people and jumps of two metres, people from 1.5 to 2 m.
#[test]
fn fifty_random_recordings_violate_no_limit_and_fail_no_solve() {
    let average = map();
    let check = |seeds: std::ops::Range<u64>| {
        for seed in seeds {
            let walker = Walker::random(seed);
            let person = Person::new(walker.settings().stature).unwrap();
            let map = average.for_stature(person.stature()).unwrap();
            let scenario = Scenario::new(walker.collect(), &person, map).unwrap();
            let separated = seed % 5 == 0;
            let scenario = if separated { scenario.with_separation() } else { scenario };
            for goal in [Goal::Ergonomics, Goal::LeastMotion] {
                assert_sound(&play(&scenario, goal), &format!("seed {seed}, {goal:?}"));
            }
        }
    };
    thread::scope(|scope| {
        scope.spawn(|| check(0..25));
        scope.spawn(|| check(25..50));
    });
}

/// Joints that start outside their limits come back, without a failure on the way.
#[test]
fn a_start_outside_the_limits_is_left_within_the_limits() {
    let mut scenario =
        Scenario::new(Walker::random(7).collect(), &Person::average(), map()).unwrap();
    scenario.start[4] = 1.9; // the second joint of the arm ends at 1.7628 rad
    scenario.start[6] = 0.1; // the fourth at -0.0698 rad
    let mut last = [0.0; 10];
    let summary = Run::new(&scenario, Goal::Ergonomics)
        .unwrap()
        .play(|row| {
            last = row.q;
            Ok(())
        })
        .unwrap();
    assert_sound(&summary, "outside");
    for (q, limits) in last.iter().zip(scenario.model.limits()) {
        assert!((limits.lower - 1e-9..=limits.upper + 1e-9).contains(q), "{q} {limits:?}");
    }
}
