//! Times of the controller's ticks in the runs of `follow`: with everything on, without torques, and as in the paper.
//!
//! Between two ticks the simulation moves robot and person and judges both. Caches are therefore as cold as in a loop
//! that shares its processor.
//!
//! Run `cargo bench -p moca-simulation --bench tick [-- NAME]`; a name plays only that run, to count its instructions:
//! `valgrind --tool=callgrind --toggle-collect='*TorqueController::step*'` for `everything`, `'*Controller::step*'` for
//! the others.
#![allow(clippy::print_stdout, missing_docs)]

use std::ops::ControlFlow;

use ergo_map::{ErgonomicsMap, MapOptions, Person};
use moca_model::Goal;
use moca_simulation::experiment::{Sight, Walk};
use moca_simulation::people::WalkerSettings;
use moca_simulation::run::{Run, Scenario};

/// Stature of the person \[m\], that of the recording of `follow`.
const STATURE: f64 = 1.75;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let only = std::env::args().skip(1).find(|name| !name.starts_with('-'));
    let person = Person::new(STATURE)?;
    let map = ErgonomicsMap::build(&person, &MapOptions::default(), None)?;
    let walk = Walk::new(WalkerSettings::default(), Sight::default())?;
    let follow = || -> Result<Scenario, Box<dyn std::error::Error>> {
        let scenario = Scenario::new(walk.percepts.clone(), &person, map.clone())?;
        let mut scenario = scenario.among(walk.others.clone())?;
        scenario.arrivals.clone_from(&walk.arrivals);
        scenario.truth.clone_from(&walk.motion);
        Ok(scenario)
    };
    let runs = [
        ("everything", follow()?),
        ("velocities", follow()?.kinematic()),
        ("paper", follow()?.as_in_paper().kinematic()),
    ];
    println!("{:<12}{:>10}{:>10}{:>10}  [µs]", "", "median", "p99", "longest");
    for (name, scenario) in &runs {
        if only.as_ref().is_none_or(|only| only == name) {
            let run = Run::new(scenario, Goal::Ergonomics)?;
            let [median, p99, longest] = run.play(|_, _| ControlFlow::Continue(()))?.tick_us;
            println!("{name:<12}{median:>10.1}{p99:>10.1}{longest:>10.1}");
        }
    }
    Ok(())
}
