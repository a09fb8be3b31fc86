//! Floors of stillness in the closed loop, judged by the true person.

use std::ops::ControlFlow;

use ergo_map::Person;
use moca_model::{BaseMotion, Goal};
use moca_simulation::judges::{Calmness, Motion};
use moca_simulation::people::{CameraSettings, Walker, WalkerSettings};
use moca_simulation::run::{Run, Scenario, TrueMotion};
use vision_models::Percept;

use crate::support::average_map;

/// Seeds of the recordings.
const SEEDS: [u64; 2] = [1, 2];
/// Time for which the base may come to rest before it stands \[s\].
const RESTS: f64 = 1.0;

/// A recording of `record` with this seed.
fn scenario(seed: u64) -> Scenario {
    played(WalkerSettings { seed, ..WalkerSettings::default() })
}

fn played(settings: WalkerSettings) -> Scenario {
    let mut walker = Walker::new(settings).unwrap();
    let (mut percepts, mut motion) = (Vec::<Percept>::new(), TrueMotion::default());
    while let Some((_, percept)) = walker.next_frame() {
        walker.motion().iter().for_each(|(time, joints)| motion.push(*time, *joints));
        percepts.extend(percept);
    }
    let scenario = Scenario::new(percepts, &Person::average(), average_map().clone()).unwrap();
    Scenario { truth: Some(motion), ..scenario }
}

/// Plays a scenario and returns its calmness and the mean of e_s; a base that is said to stand has no velocity at all.
fn play(scenario: &Scenario) -> (Calmness, f64) {
    let (mut stands, mut moving, mut still) = (0.0, 0, 0);
    let summary = Run::new(scenario, Goal::Ergonomics)
        .unwrap()
        .play(|row, plant| {
            let command = plant.command();
            if command.base_motion == BaseMotion::Stands {
                stands += scenario.settings.period;
                let moves = command.joint_velocity[..3].iter().any(|velocity| *velocity != 0.0);
                moving += u64::from(moves);
                still += u64::from(!moves);
                assert!(!moves || stands < RESTS, "{} s: {:?}", row.time, command.joint_velocity);
            } else {
                stands = 0.0;
            }
            ControlFlow::Continue(())
        })
        .unwrap();
    println!("stands {still} ticks, comes to rest in {moving}; {:#?}", summary.calmness);
    assert!(still > 5_000, "{still}");
    (summary.calmness, summary.score_mean)
}

/// The floors are those of the mean over recordings.
#[test]
fn the_robot_is_still_without_separation() {
    let play = |seed| play(&scenario(seed).without_separation()).0.standing.unwrap();
    let runs = SEEDS.map(play);
    let mean = |of: fn(&Motion) -> f64| runs.iter().map(of).sum::<f64>() / runs.len() as f64;
    assert!(runs.iter().all(|run| run.duration > 10.0), "{runs:?}");
    assert!(mean(|run| run.workpiece) <= 0.02, "{runs:?}");
    assert!(mean(|run| run.workpiece_p99) <= 0.07, "{runs:?}");
    assert!(mean(|run| run.base_at_rest) >= 0.92, "{runs:?}");
    assert!(mean(|run| run.base_at_limit) <= 0.03, "{runs:?}");
    assert!(mean(|run| run.base_reversals) <= 0.5, "{runs:?}");
    assert!(mean(|run| run.joints) <= 0.08, "{runs:?}");
}

/// Limits of separation move with every camera frame, so that the floors are those of today. The workpiece comes to
/// rest within 2 s, in a good place.
#[test]
fn separation_moves_the_robot_little() {
    for seed in SEEDS {
        let (calmness, score) = play(&scenario(seed));
        assert!(score <= 0.22, "{score}");
        let (standing, settled) = (calmness.standing.unwrap(), calmness.settled.unwrap());
        assert!(standing.duration > 10.0, "{standing:?}");
        assert!(standing.workpiece <= 0.05, "{standing:?}");
        assert!(standing.base_at_rest >= 0.5, "{standing:?}");
        assert!(settled.workpiece <= 0.02, "{settled:?}");
    }
}

/// The robot measures itself with ten times its usual noise, and the camera has none.
#[test]
fn own_noise_leaves_the_robot_at_rest() {
    let settings = WalkerSettings { seed: 2, ..WalkerSettings::default() };
    let camera = CameraSettings { noise: 0.0, ..settings.camera };
    let mut scenario = played(WalkerSettings { camera, ..settings });
    scenario.robot = scenario.robot.with_noise(10.0);
    let standing = play(&scenario).0.standing.unwrap();
    assert!(standing.workpiece <= 0.008 && standing.base_at_rest >= 0.98, "{standing:?}");
}
