//! A person walks, a robot with a URDF of your own follows, and a page of the run is written.

use std::{fs, ops::ControlFlow};

use moca_replay::page::page;
use moca_simulation::ergo_map::{ErgonomicsMap, MapOptions, Person};
use moca_simulation::hrsw_safety::{Capsule, LinkCapsule, SafetySettings};
use moca_simulation::moca_model::nalgebra::Vector3;
use moca_simulation::moca_model::whole_body::{Description, Model, robot::LimitOverride};
use moca_simulation::moca_model::{ControllerSettings, Goal, PostureSettings, moca_safety};
use moca_simulation::people::{Walker, WalkerSettings};
use moca_simulation::run::{Comparison, Run, Scenario};

/// The URDF of any robot: here a lift with a wrist, on an omnidirectional base.
const URDF: &str = include_str!("robot.urdf");
/// Start configuration: base x, y and yaw, then lift and wrist \[m, rad\].
const START: [f64; 7] = [0.0, 0.0, 0.0, 0.6, 0.0, 0.0, 0.0];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A person of 1.75 m comes with an object, works on it and walks on.
    let walker = Walker::new(WalkerSettings { duration: 20.0, ..WalkerSettings::default() })?;
    let person = Person::new(walker.settings().stature)?;
    let map =
        ErgonomicsMap::build(&person, &MapOptions { spacing: 0.1, ..MapOptions::default() }, None)?;

    let (linear, angular) = (LimitOverride::of_speed(1.5, 0.6), LimitOverride::of_speed(2.0, 1.5));
    let description = Description::on_planar_base(linear, angular);
    let robot = Model::from_urdf(URDF, &description)?;
    let body = |link: &str, capsule| LinkCapsule { link: link.to_owned(), capsule };
    let settings = ControllerSettings {
        tool: "tool".to_owned(),
        posture: PostureSettings {
            configuration: START.to_vec(),
            gain: vec![0.0; 7],
            weight: vec![1.0; 7],
        },
        safety: SafetySettings {
            bodies: vec![
                body("base", Capsule::new(Vector3::zeros(), Vector3::z() * 0.1, 0.4)?),
                body("carriage", Capsule::new(Vector3::zeros(), Vector3::x() * 0.4, 0.06)?),
            ],
            own_pairs: Vec::new(),
            ..moca_safety()
        },
        ..ControllerSettings::default()
    };
    let scenario = Scenario::new(walker.collect(), &person, map)?
        .with_robot(robot, &START, settings)
        .kinematic();

    let mut recorder = scenario.recorder("A lift follows", URDF)?;
    let run = Run::new(&scenario, Goal::Ergonomics)?.recorded_by(&mut recorder);
    let on = run.play(|_, _| ControlFlow::Continue(()))?;
    let came_to = Comparison { separation: scenario.has_separation(), on, off: None };
    assert!(came_to.on.together > 3.0 && came_to.on.limit_violations == 0, "{came_to}");
    fs::write(
        "own_robot.html",
        page("A robot of one's own", &[&recorder.finish()], &came_to.results("")?)?,
    )?;
    Ok(())
}
