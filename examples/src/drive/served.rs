//! The simulated robot on the ROS 2 graph.

use std::io::Write;

use anyhow::{Result, ensure};
use moca_drivers::ros2::{Ros2Server, RosDomain, ServedRobot, TopicReport};
use moca_drivers::{RecordedCamera, TopicNames};
use moca_model::whole_body::control_loop::{MonotonicClock, Scheduling};
use moca_model::{MOCA_HOME, Scene};
use moca_simulation::run::{Encounter, RobotView, Scenario};

use super::beneath::beneath;
use super::own_robot::DrivenRobot;
use crate::program::Session;

/// Runs the simulated robot until Ctrl-C, with the person of the scenario before its camera. Its on-board camera sees the
/// object that it was handed.
///
/// # Errors
/// Another robot than MOCA, a graph that cannot be joined, and a topic that cannot be read. A priority that the system
/// does not grant is one, too.
pub fn serve_on_ros2(
    session: &mut Session,
    scenario: &Scenario,
    topics: &TopicNames,
    (clock, scheduling): (&mut MonotonicClock, Scheduling),
) -> Result<()> {
    let (settings, start) = (&scenario.settings, &scenario.start);
    ensure!(*start == MOCA_HOME, "--ros2 --serve: only MOCA is simulated on ROS 2");
    let robot = DrivenRobot::from(scenario).simulated()?;
    let domain = RosDomain::of_environment()?;
    let joined = beneath(scheduling, || Ros2Server::join(domain, topics, robot, start))?;
    let mut server = joined?;
    writeln!(session.output(), "a robot on ROS 2; Ctrl-C ends it")?;
    session.output().flush()?;
    let mut encounter = Encounter::new(scenario);
    let see = |frame: Scene, robot: &ServedRobot| seen(&mut encounter, scenario, frame, robot);
    let (camera, interrupt) = (RecordedCamera::new(scenario.scenes()), session.interrupt().clone());
    server.serve(settings.period, camera, see, (clock, scheduling), || interrupt.requested())?;
    for topic in &server.statistics() {
        writeln!(session.output(), "{}", TopicReport::from(topic))?;
    }
    Ok(())
}

/// Percept of a frame by the cameras beside the robot.
fn seen(
    encounter: &mut Encounter,
    scenario: &Scenario,
    mut frame: Scene,
    robot: &ServedRobot,
) -> Scene {
    let &ServedRobot { base, tool, holds } = robot;
    let view = RobotView { camera: scenario.settings.on_board_camera, base, tool, holds };
    if let Ok(percept) = encounter.show(&frame.percept, &view) {
        frame.percept = percept;
    }
    frame
}
