//! Measurements stop or freeze in the middle of `follow`. The true joints of the simulated robot are judged.

use ergo_map::Person;
use moca_model::{Controller, MOCA_BASE_JOINTS};
use moca_simulation::plant::{Heard, Plant};
use moca_simulation::run::Scenario;
use nalgebra::Vector3;

use crate::support::{average_map, recorded};

/// Number of moments of the run at which measurements stop.
const MOMENTS: usize = 50;
/// Number of ticks without measurements that cause no fault, and number of ticks until a fault is reported at the
/// latest.
const BRIDGED: u32 = 3;
const FAULT: u32 = 10;
/// Number of ticks after which a loop halts a robot without measurements.
const BLIND: u32 = 100;

/// The behaviour of a robot whose measurements stop at a moment.
struct Outcome {
    /// Largest excess speed of a joint over 1.2 times its speed at the beginning plus 0.1 rad/s \[rad/s\].
    excess: f64,
    /// Tick in which the first fault is reported.
    fault: Option<u32>,
}

fn arm(plant: &Plant) -> Vec<f64> {
    let velocity = plant.velocity().unwrap();
    velocity[MOCA_BASE_JOINTS..].iter().map(|velocity| velocity.abs()).collect()
}

/// The controller gets this measurement for `ticks` ticks, then true ones for 0.1 s. After 0.1 s no command is sent, as
/// by a loop that halts a robot without measurements.
fn branch(plant: &Plant, begin: f64, heard: Heard, ticks: u32) -> Outcome {
    let mut plant = plant.clone();
    let before = arm(&plant);
    let mut outcome = Outcome { excess: f64::NEG_INFINITY, fault: None };
    // Disturbances that end before a fault are followed by any command.
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
        plant.act(&Vector3::zeros()).unwrap();
        for (now, before) in arm(&plant).iter().zip(&before) {
            outcome.excess = outcome.excess.max(now - (1.2 * before + 0.1));
        }
    }
    outcome
}

/// 50 moments of the loop of `follow` without a push on the grasped object. Under a lasting push an arm without
/// measurements moves, whatever controls it.
fn moments() -> Vec<(f64, Plant)> {
    let scenario = Scenario::new(recorded(), &Person::average(), average_map().clone()).unwrap();
    let Scenario { model, ergonomics, settings, start, torques, .. } = &scenario;
    let controller = Controller::new(model.clone(), *ergonomics, settings.clone(), start).unwrap();
    let mut plant =
        Plant::with_torques(scenario.drive, controller, torques.clone(), &scenario.robot, 1)
            .unwrap();
    plant.grasp(&scenario.object).unwrap();
    let begin = scenario.percepts.first().unwrap().time;
    let ticks = 1e3 * scenario.duration();
    let (mut frames, mut next) = (scenario.percepts.iter().peekable(), 0.03 * ticks);
    let (mut tick, mut moments) = (0.0, Vec::new());
    while tick < ticks && moments.len() < MOMENTS {
        let now = begin + 1e-3 * tick;
        while let Some(percept) = frames.next_if(|percept| percept.time <= now) {
            plant.observe(percept).unwrap();
        }
        plant.step(now).unwrap();
        plant.act(&Vector3::zeros()).unwrap();
        if tick > next {
            moments.push((now, plant.clone()));
            next += ticks * (0.4 + (moments.len() * 37 % 17) as f64 / 14.0) / 50.0;
        }
        tick += 1.0;
    }
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
            // This line is for the table of the book.
            println!("bound {heard:?} {ticks} ms: {worst:.4} rad/s, fault {latest} ms");
        }
    }
}
