//! Measurements that stop or freeze in the middle of `follow`, judged by the true joints of the simulated robot.

use ergo_map::Person;
use examples::follow::{Run, Scenario};
use examples::plant::{Heard, Plant};
use examples::recording;
use moca_model::{Goal, MOCA_BASE_JOINTS};
use nalgebra::Vector3;
use vision_models::Percept;

use crate::support::average_map;

/// Moments of the run at which measurements stop.
const MOMENTS: usize = 50;
/// Ticks for which they may be missing without a fault.
const BRIDGED: u32 = 3;

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

/// For so many ticks the controller hears this; then for 0.1 s the robot again.
fn branch(plant: &Plant, begin: f64, heard: Heard, ticks: u32) -> Outcome {
    let mut plant = plant.clone();
    let before = arm(&plant);
    let mut outcome = Outcome { excess: f64::NEG_INFINITY, fault: None };
    // What ends sooner than a fault is followed by whatever the robot is told.
    let judged = if ticks > 10 { ticks + 100 } else { ticks };
    for tick in 1..=judged {
        let heard = if tick <= ticks { heard } else { Heard::Measurement };
        plant.step_measuring(begin + 1e-3 * f64::from(tick), heard, |_| {}).unwrap();
        if plant.command().fault.is_some() {
            outcome.fault = outcome.fault.or(Some(tick));
        }
        plant.act(&Vector3::zeros()).unwrap();
        for (now, before) in arm(&plant).iter().zip(&before) {
            outcome.excess = outcome.excess.max(now - (1.2 * before + 0.1));
        }
    }
    outcome
}

#[test]
fn no_joint_runs_away_when_measurements_stop() {
    let percepts: Vec<Percept> = recording::shipped().unwrap().map(Result::unwrap).collect();
    let scenario = Scenario::new(percepts, &Person::average(), average_map().clone()).unwrap();
    let ticks = 1e3 * scenario.duration();
    let mut next = 0.03 * ticks;
    let mut moments = Vec::new();
    let mut tick = 0.0;
    Run::new(&scenario, Goal::Ergonomics)
        .unwrap()
        .play_watched(|row, plant| {
            tick += 1.0;
            if tick > next && moments.len() < MOMENTS {
                // The end of the tick has been acted upon after the next one begins: begin with that.
                moments.push((row.time, plant.clone()));
                next += ticks * (0.4 + f64::from(moments.len() as u32 * 37 % 17) / 14.0) / 50.0;
            }
            Ok(())
        })
        .unwrap();
    assert!(moments.len() >= 45, "{}", moments.len());
    let fastest = moments.iter().flat_map(|(_, plant)| arm(plant)).fold(0.0, f64::max);
    println!("fastest {fastest}");
    for (heard, ticks) in [
        (Heard::Nothing, BRIDGED),
        (Heard::Nothing, 5),
        (Heard::Nothing, 19),
        (Heard::Nothing, 100),
        (Heard::Nothing, 1000),
        (Heard::Frozen, BRIDGED),
        (Heard::Frozen, 100),
        (Heard::Frozen, 1000),
    ] {
        let mut worst = f64::NEG_INFINITY;
        let (mut late, mut none) = (0, 0);
        for (moment, (time, plant)) in moments.iter().enumerate() {
            let mut plant = plant.clone();
            plant.act(&Vector3::zeros()).unwrap();
            let outcome = branch(&plant, *time, heard, ticks);
            if outcome.excess > 0.0 {
                println!("   moment {moment} {time} {}", outcome.excess);
            }
            worst = worst.max(outcome.excess);
            match outcome.fault {
                Some(t) => late = late.max(t),
                None => none += 1,
            }
        }
        println!("{heard:?} {ticks}: {worst:.3} fault by {late}, none {none}");
    }
}
