//! Robots over DDS on this machine.

use std::cell::Cell;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use moca_drivers::SimulatedSide;
use moca_drivers::ros2::{JointInterface, RobotJoints, Ros2Server, Ros2Side, RosDomain, Topic};
use moca_model::MOCA_HOME;
use moca_model::whole_body::control_loop::{
    ControlLaw, ControlLoop, JointCommand, JointMeasurement, LoopSettings, MonotonicClock,
    StopCause,
};
use moca_simulation::plant::RobotNoise;

use crate::robot_side::at_rest;
use crate::support::{Runs, coarse_map_file};

/// Turns the base at 0.2 rad/s, supports the arm by the measured torques, and counts its steps.
struct Turn<'a>(&'a Cell<u32>);

impl ControlLaw for Turn<'_> {
    type Error = std::convert::Infallible;

    fn step(
        &mut self,
        _now: f64,
        measured: &JointMeasurement,
        command: &mut JointCommand,
    ) -> Result<(), Self::Error> {
        self.0.set(self.0.get() + 1);
        command.velocity[2] = 0.2;
        for (own, torque) in command.torque.iter_mut().zip(&measured.torque) {
            *own = torque.unwrap_or_default();
        }
        Ok(())
    }

    fn perception_age(&self) -> Option<f64> {
        None
    }

    fn request_stop(&mut self) {}

    fn is_at_rest(&self, _measured: &JointMeasurement) -> Option<bool> {
        Some(true)
    }
}

#[test]
fn a_loop_moves_a_robot_on_ros2() {
    // No other test uses this domain.
    let domain = RosDomain::parse("77").unwrap();
    let robot = SimulatedSide::new(&MOCA_HOME, 1e-3, RobotNoise::new(1)).unwrap();
    let mut server = Ros2Server::join(domain, robot, &MOCA_HOME).unwrap();
    let over = AtomicBool::new(false);
    thread::scope(|scope| {
        scope.spawn(|| {
            let stop = || over.load(Ordering::Relaxed);
            server.serve(1e-3, &[], &mut MonotonicClock::default(), stop).unwrap();
        });
        let (mut side, _) =
            Ros2Side::join(domain, RobotJoints::moca(), JointInterface::Effort).unwrap();
        // The timeout must suit a busy machine.
        let patient = LoopSettings {
            robot_timeout: 20.0,
            first_measurement: 60.0,
            ..LoopSettings::default()
        };
        let mut control = ControlLoop::new(patient, at_rest(MOCA_HOME.len())).unwrap();
        let (steps, mut clock) = (Cell::new(0), MonotonicClock::default());
        let ending = control.run(&mut side, &mut Turn(&steps), &mut clock, || steps.get() > 200);
        over.store(true, Ordering::Relaxed);
        assert_eq!(ending.unwrap().cause, StopCause::Requested);
        let measured = control.measured();
        assert_eq!(measured.torque[..3], [None; 3], "the base measures none");
        assert!(measured.torque[3..].iter().all(Option::is_some));
        let turned = measured.position[2];
        assert!(turned > 1e-3, "{turned} rad");
        let statistics = side.close().unwrap();
        assert!(statistics.published > 0);
        let states = statistics.topics.iter().find(|topic| topic.topic == Topic::JointStates);
        assert!(states.unwrap().taken > 0);
    });
}

#[test]
fn drive_says_what_is_wrong_with_ros2() {
    let drive = || Runs::new("drive").with(&["--map", coarse_map_file(), "--ros2"]);
    drive().with(&["--robot=127.0.0.1:5005"]).run().failed(2, "--robot");
    drive().with(&["--serve", "127.0.0.1:5005"]).run().failed(1, "give no address");
    Runs::new("drive")
        .with(&["--map", coarse_map_file(), "--serve"])
        .run()
        .failed(1, "give an address");
}
