//! The controller and a simulated robot meet a person who stands and uses a drill.
#![allow(clippy::print_stdout)]

use ergo_map::{ErgonomicsMap, FitOptions, MapOptions, Person};
use moca_model::nalgebra::Point3;
use moca_model::{Controller, ControllerSettings, MOCA_HOME, SimulatedRobot, SpaceSettings, moca};
use vision_models::{Action, Body, Body25, Confidence, Keypoint, Percept, RecognisedAction, Tool};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // This is done once for each person.
    let person = Person::new(1.75)?;
    let map = ErgonomicsMap::build(
        &person,
        &MapOptions { spacing: 0.08, ..MapOptions::default() },
        None,
    )?;
    let (ergonomics, _report) = map.fit(&FitOptions::default())?;
    let space = SpaceSettings::default().for_person(&person, map.side());
    let settings = ControllerSettings { space, ..ControllerSettings::default() };
    let mut controller = Controller::new(moca()?, ergonomics, settings, &MOCA_HOME)?;
    let mut robot = SimulatedRobot::new(&moca()?, &MOCA_HOME)?;

    // A person who stands 1.7 m ahead, faces the robot and drills.
    let confidence = Confidence::new(0.9)?;
    let mut body = Body::default();
    for (joint, y, z) in [
        (Body25::LeftShoulder, -0.2, 1.4),
        (Body25::RightShoulder, 0.2, 1.4),
        (Body25::MidHip, 0.0, 0.9),
    ] {
        body.set(joint, Some(Keypoint { position: Point3::new(1.7, y, z), confidence }));
    }
    let action = Some(RecognisedAction { action: Action::Using(Tool::Drill), confidence });
    for tick in 1..=2000 {
        let time = 1e-3 * f64::from(tick);
        if tick % 50 == 0 {
            let body = Some(body.clone());
            controller.observe(&Percept { time, body, action, surface: None })?;
        }
        let command = controller.step(time, robot.position())?;
        assert!(command.outcome.is_optimal());
        robot.step(&command.joint_velocity, 1e-3)?; // the base's twist and the arm's positions, on a real one
    }
    let tool = controller.actual().translation.vector;
    println!("the tool at {:.3} {:.3} {:.3} m", tool.x, tool.y, tool.z);
    Ok(())
}
