//! Measurements that stop or freeze in the middle of `follow`, judged by the true joints of the simulated robot.

use ergo_map::Person;
use examples::follow::{Run, Scenario};
use examples::plant::{Heard, Plant};
use examples::recording;
use moca_model::{Goal, MOCA_BASE_JOINTS};
use vision_models::Percept;

use crate::support::average_map;

/// Moments of the run at which measurements stop.
const MOMENTS: usize = 50;
/// Ticks for which they may be missing without a fault, and in which one is named at the latest.
const BRIDGED: u32 = 3;
const FAULT: u32 = 10;
/// Ticks after which a loop halts a robot that it does not see.
const BLIND: u32 = 100;

/// What a robot does whose measurements stop at a moment.
struct Outcome {
    /// The most by which a joint is faster than 1.2 times as when it began, and 0.1 rad/s [rad/s].
    excess: f64,
    /// In which tick the first fault is named.
    fault: Option<u32>,
}

fn arm(plant: &Plant) -> Vec<f64> {
    let velocity = plant.velocity().unwrap();
    velocity[MOCA_BASE_JOINTS..].iter().map(|velocity| velocity.abs()).collect()
}

/// For so many ticks the controller hears this; then for 0.1 s the robot again. After 0.1 s no command comes any more, as
/// from a loop that halts a robot that it does not see.
fn branch(plant: &Plant, begin: f64, heard: Heard, ticks: u32) -> Outcome {
    let mut plant = plant.clone();
    let before = arm(&plant);
    // The person goes on working as at that moment.
    let push = *plant.push();
    let mut outcome = Outcome { excess: f64::NEG_INFINITY, fault: None };
    // What ends sooner than a fault is followed by whatever the robot is told.
    let judged = if ticks > FAULT { ticks + 100 } else { ticks };
    for tick in 1..=judged {
        let heard = if tick <= ticks { heard } else { Heard::Measurement };
        plant.step_measuring(begin + 1e-3 * f64::from(tick), heard, |_| {}).unwrap();
        if plant.command().fault.is_some() {
            outcome.fault = outcome.fault.or(Some(tick));
        }
        if tick > BLIND {
            plant.lose_commands(1.0).unwrap();
        }
        plant.act(&push).unwrap();
        for (now, before) in arm(&plant).iter().zip(&before) {
            outcome.excess = outcome.excess.max(now - (1.2 * before + 0.1));
        }
    }
    outcome
}

/// 50 moments of the run, each with the loop as it then is.
fn moments() -> Vec<(f64, Plant)> {
    let percepts: Vec<Percept> = recording::shipped().unwrap().map(Result::unwrap).collect();
    let scenario = Scenario::new(percepts, &Person::average(), average_map().clone()).unwrap();
    let ticks = 1e3 * scenario.duration();
    let (mut tick, mut next) = (0.0, 0.03 * ticks);
    let mut moments = Vec::new();
    Run::new(&scenario, Goal::Ergonomics)
        .unwrap()
        .play_watched(|row, plant| {
            tick += 1.0;
            if tick > next && moments.len() < MOMENTS {
                let mut plant = plant.clone();
                let push = *plant.push();
                plant.act(&push)?;
                moments.push((row.time, plant));
                next += ticks * (0.4 + (moments.len() * 37 % 17) as f64 / 14.0) / 50.0;
            }
            Ok(())
        })
        .unwrap();
    moments
}

#[test]
fn no_joint_runs_away_when_measurements_stop() {
    let moments = moments();
    assert_eq!(moments.len(), MOMENTS);
    let fastest = moments.iter().flat_map(|(_, plant)| arm(plant)).fold(0.0, f64::max);
    assert!(fastest > 0.5, "the arm moves: {fastest} rad/s");
    for heard in [Heard::Nothing, Heard::Frozen] {
        for ticks in [BRIDGED, 5, 19, 100, 1000] {
            let outcomes = moments.iter().map(|(time, plant)| branch(plant, *time, heard, ticks));
            let (mut worst, mut latest) = (f64::NEG_INFINITY, 0);
            for (moment, Outcome { excess, fault }) in outcomes.enumerate() {
                let what = format!("{heard:?} for {ticks} ms at moment {moment}");
                assert!(excess <= 0.0, "{what}: {excess} rad/s too fast");
                match fault {
                    None => assert!(ticks < FAULT, "{what}: no fault"),
                    Some(tick) => assert!(ticks > BRIDGED && tick <= FAULT, "{what}: at {tick}"),
                }
                worst = worst.max(excess);
                latest = latest.max(fault.unwrap_or_default());
            }
            // For the table of the book.
            println!("bound {heard:?} {ticks} ms: {worst:.4} rad/s, fault {latest} ms");
        }
    }
}
