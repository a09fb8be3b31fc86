//! Robots over DDS on this machine.

use std::cell::Cell;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use moca_drivers::ros2::messages::{Empty, Text};
use moca_drivers::ros2::ros2_client::{
    Context, ContextOptions, MessageTypeName, Name, NodeName, NodeOptions, QosProfile,
};
use moca_drivers::ros2::{JointInterface, RobotJoints, Ros2Server, Ros2Side, RosDomain, Topic};
use moca_drivers::{RecordedCamera, SimulatedSide, TopicNames};
use moca_model::MOCA_HOME;
use moca_model::whole_body::control_loop::{
    ControlLaw, ControlLoop, Grip, JointCommand, JointMeasurement, LoopSettings, MonotonicClock,
    Scheduling, StopCause,
};
use moca_simulation::plant::RobotNoise;
use vision_models::{Confidence, Percept, RecognisedSurface, Surface};

use crate::robot_side::at_rest;
use crate::support::{Runs, coarse_map_file};

/// Turns the base at 0.2 rad/s, supports the arm by the measured torques, and closes the gripper. It counts its steps, and
/// remembers whether the gripper holds something.
struct Turn<'a>(&'a Cell<u32>, &'a Cell<bool>);

impl ControlLaw for Turn<'_> {
    type Error = std::convert::Infallible;

    fn step(
        &mut self,
        _now: f64,
        measured: &JointMeasurement,
        command: &mut JointCommand,
    ) -> Result<(), Self::Error> {
        self.0.set(self.0.get() + 1);
        self.1.set(measured.robot.holds == Some(true));
        command.grip = Some(Grip::Close);
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
    let mut server = Ros2Server::join(domain, &TopicNames::default(), robot, &MOCA_HOME).unwrap();
    let over = AtomicBool::new(false);
    thread::scope(|scope| {
        scope.spawn(|| {
            let stop = || over.load(Ordering::Relaxed);
            let surface =
                RecognisedSurface { surface: Surface::Drilled, confidence: Confidence::ONE };
            let percept = Percept { time: 0.0, body: None, action: None, surface: Some(surface) };
            let camera = RecordedCamera::new(vec![percept.into()]);
            server
                .serve(
                    1e-3,
                    camera,
                    |frame, _| frame,
                    (&mut MonotonicClock::default(), Scheduling::default()),
                    stop,
                )
                .unwrap();
        });
        let (mut side, people) = Ros2Side::join(
            domain,
            &TopicNames::default(),
            RobotJoints::moca(),
            JointInterface::Effort,
        )
        .unwrap();
        // The timeout must suit a busy machine.
        let patient = LoopSettings {
            robot_timeout: 20.0,
            first_measurement: 60.0,
            ..LoopSettings::default()
        };
        let mut control = ControlLoop::new(patient, at_rest(MOCA_HOME.len())).unwrap();
        let (steps, holds, mut clock) = (Cell::new(0), Cell::new(false), MonotonicClock::default());
        let mut sees = false;
        let enough = || {
            let is_drilled = |seen: RecognisedSurface| seen.surface == Surface::Drilled;
            sees |= people.seen.try_iter().any(|seen| seen.surface.is_some_and(is_drilled));
            (steps.get() > 200 && holds.get() && sees) || steps.get() > 20_000
        };
        let ending = control.run(&mut side, &mut Turn(&steps, &holds), &mut clock, enough);
        over.store(true, Ordering::Relaxed);
        assert_eq!(ending.unwrap().cause, StopCause::Requested);
        let measured = control.measured();
        assert_eq!(measured.torque[..3], [None; 3], "the base measures none");
        assert!(measured.torque[3..].iter().all(Option::is_some));
        assert!(holds.get() && sees, "holds {}, sees {sees}", holds.get());
        let turned = measured.position[2];
        assert!(turned > 1e-3, "{turned} rad");
        let statistics = side.close().unwrap();
        assert!(statistics.published > 0);
        let states = statistics.topics.iter().find(|topic| topic.topic == Topic::JointStates);
        assert!(states.unwrap().taken > 0);
    });
}

/// Another node acknowledges, and hears the state of the loop.
#[test]
fn graph_acknowledges_and_hears_the_state() {
    // No other test uses this domain.
    let domain = RosDomain::parse("78").unwrap();
    let (side, people) =
        Ros2Side::join(domain, &TopicNames::default(), RobotJoints::moca(), JointInterface::Effort)
            .unwrap();
    let options = ContextOptions::new().domain_id(domain.number());
    let context = Context::with_options(options).unwrap();
    let options = NodeOptions::new().enable_rosout(false).start_parameter_services(false);
    let mut node = context.new_node(NodeName::new("/", "somebody").unwrap(), options).unwrap();
    let topic = |name: &str, kind: &str, qos: &QosProfile| {
        let kind = MessageTypeName::new("std_msgs", kind);
        node.create_topic(&Name::parse(name).unwrap(), kind, qos).unwrap()
    };
    let acknowledge = topic("/acknowledge", "Empty", &QosProfile::publisher_default());
    let state = topic("/control_state", "String", &QosProfile::subscription_default());
    let acknowledge = node.create_publisher::<Empty>(&acknowledge, None).unwrap();
    let state = node.create_subscription::<Text>(&state, None).unwrap();
    let (mut acknowledged, mut heard) = (false, false);
    for _ in 0..600 {
        if acknowledged && heard {
            break;
        }
        acknowledge.publish(Empty::default()).unwrap();
        people.tell("apart; normal".to_owned());
        thread::sleep(Duration::from_millis(50));
        acknowledged |= people.acknowledgements.try_recv().is_ok();
        heard |= matches!(state.take(), Ok(Some((text, _))) if text.data == "apart; normal");
    }
    assert!(acknowledged && heard, "acknowledged {acknowledged}, heard {heard}");
    let topics = side.close().unwrap().topics;
    let taken = topics.iter().find(|topic| topic.topic == Topic::Acknowledge).unwrap().taken;
    assert!(taken > 0);
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
