//! Missing measurements are not zero: the robot is never bolder if an interface leaves something out.
//!
//! Two runs see the same person; the second one lacks something. A run is bolder if it permits a contact at a higher
//! speed, or a joint of the true person is nearer. It is also bolder if it has more room above the protective distance
//! or a larger share of the speeds.

use ergo_map::ErgonomicsQuadratic;
use hrsw_safety::{Capsule, SafetyState, proximity};
use moca_model::whole_body::Data;
use moca_model::whole_body::control_loop::{ControlLaw, JointCommand, RobotMode, RobotStatus};
use moca_model::{
    Controller, ControllerSettings, DynamicRobot, DynamicRobotSettings, MOCA_HOME,
    TorqueController, TorqueLoopSettings,
};
use nalgebra::{Matrix3, Point3, Vector3};
use vision_models::{
    Action, Body, Body25, Confidence, Keypoint, Percept, RecognisedAction, RecognisedSurface,
    Surface, Tool,
};

use crate::drive::{FRAME, PERIOD, loop_controller};
use crate::shared::MOCA;
use crate::torque::Noise;

/// A standing person of 1.75 m with the hands in front: forwards, to the left, up \[m\].
const JOINTS: [(Body25, [f64; 3]); 19] = {
    use Body25::*;
    [
        (Nose, [0.10, 0.0, 1.60]),
        (Neck, [0.0, 0.0, 1.45]),
        (RightShoulder, [0.0, -0.19, 1.43]),
        (RightElbow, [0.0, -0.22, 1.12]),
        (RightWrist, [0.2, -0.2, 1.0]),
        (LeftShoulder, [0.0, 0.19, 1.43]),
        (LeftElbow, [0.0, 0.22, 1.12]),
        (LeftWrist, [0.2, 0.2, 1.0]),
        (MidHip, [0.0, 0.0, 0.93]),
        (RightHip, [0.0, -0.1, 0.92]),
        (RightKnee, [0.0, -0.1, 0.5]),
        (RightAnkle, [0.0, -0.1, 0.08]),
        (LeftHip, [0.0, 0.1, 0.92]),
        (LeftKnee, [0.0, 0.1, 0.5]),
        (LeftAnkle, [0.0, 0.1, 0.08]),
        (RightEye, [0.09, -0.03, 1.63]),
        (LeftEye, [0.09, 0.03, 1.63]),
        (RightEar, [0.02, -0.08, 1.62]),
        (LeftEar, [0.02, 0.08, 1.62]),
    ]
};

/// The place of the person at a time, who approaches at 0.8 m/s and stays in front of the robot.
fn place(time: f64) -> f64 {
    (3.5 - 0.8 * time).max(1.3)
}

/// The place of a joint of the person, who looks at the robot.
fn joint(time: f64, [forwards, left, up]: [f64; 3]) -> Point3<f64> {
    Point3::new(place(time) - forwards, -left, up)
}

fn everything(time: f64) -> Percept {
    let mut body = Body::default();
    for (name, at) in JOINTS {
        let keypoint = Keypoint { position: joint(time, at), confidence: Confidence::ONE };
        body.set_measured(name, keypoint, Matrix3::identity() * 0.02_f64.powi(2));
    }
    let confidence = Confidence::ONE;
    let action = Some(RecognisedAction { action: Action::Using(Tool::Drill), confidence });
    let surface = Some(RecognisedSurface { surface: Surface::Smooth, confidence });
    Percept { time, body: Some(body), action, surface }
}

/// The permissions of a tick and their effects.
#[derive(Debug, Clone, Copy)]
struct Boldness {
    contact_speed: f64,
    room: f64,
    scale: f64,
    distance: f64,
}

/// A run of the robot under torques in front of the person.
struct Run {
    controller: TorqueController,
    robot: DynamicRobot,
    noise: Noise,
    tick: u32,
    ticks: Vec<Boldness>,
}

impl Run {
    fn new() -> Self {
        let ergonomics =
            ErgonomicsQuadratic::new(Matrix3::identity(), Vector3::new(-0.4, 0.1, -1.1), 0.8);
        let settings = ControllerSettings::default();
        let controller = Controller::new(MOCA.clone(), ergonomics.unwrap(), settings, &MOCA_HOME);
        let torques = TorqueLoopSettings::new(moca_model::whole_body::torque::Compensation::BARE);
        Self {
            controller: TorqueController::new(controller.unwrap(), torques).unwrap(),
            robot: DynamicRobot::new(&MOCA, &DynamicRobotSettings::default(), &MOCA_HOME).unwrap(),
            noise: Noise::new(5),
            tick: 0,
            ticks: Vec::new(),
        }
    }

    fn step(&mut self, see: &dyn Fn(f64) -> Percept, torque: &dyn Fn(&mut [Option<f64>])) {
        let now = f64::from(self.tick) * PERIOD;
        if self.tick.is_multiple_of(FRAME) {
            self.controller.observe(see(now)).unwrap();
        }
        self.robot.measure(&mut self.noise).unwrap();
        let mut measured = self.robot.measured().clone();
        torque(&mut measured.torque);
        self.controller.step(now, &measured).unwrap();
        let (command, torque) = (self.controller.controller().command(), self.controller.torque());
        assert_eq!(command.fault, None, "at {now} s");
        self.robot.step(command, torque, &[], PERIOD, &mut self.noise).unwrap();
        let safety = self.controller.controller().safety();
        self.ticks.push(Boldness {
            contact_speed: safety.contact_speed(),
            room: safety.nearest().map_or(f64::INFINITY, hrsw_safety::Nearest::room),
            scale: safety.speed_scale(),
            distance: self.distance(now),
        });
        self.tick += 1;
    }

    /// The distance of the true robot to the true person's joints and trunk \[m\].
    fn distance(&self, now: f64) -> f64 {
        let mut data = Data::new(&MOCA);
        let posed = data.pose(&MOCA, self.robot.simulation().position()).unwrap();
        let at = |index: usize| joint(now, JOINTS[index].1).coords;
        let trunk = Capsule::new(at(1), at(8), 0.1).unwrap();
        let joints = (0..JOINTS.len())
            .map(|index| Capsule::new(at(index), at(index) + Vector3::z() * 1e-6, 0.05).unwrap());
        let parts: Vec<_> = joints.chain([trunk]).collect();
        let bodies = &self.controller.controller().settings().safety.bodies;
        let distances = bodies.iter().flat_map(|body| {
            let link = MOCA.frame_id(&body.link).unwrap();
            let capsule = body.capsule.placed(&posed.world_from(link).unwrap());
            parts.iter().map(move |part| proximity(&capsule, part).distance).collect::<Vec<_>>()
        });
        distances.fold(f64::INFINITY, f64::min)
    }

    fn state(&self) -> SafetyState {
        self.controller.controller().safety().supervisor().state()
    }
}

fn run(seconds: f64, see: impl Fn(f64) -> Percept, torque: impl Fn(&mut [Option<f64>])) -> Run {
    let mut run = Run::new();
    while f64::from(run.tick) * PERIOD < seconds {
        run.step(&see, &torque);
    }
    run
}

fn all_torques(_: &mut [Option<f64>]) {}

fn least(ticks: &[Boldness]) -> f64 {
    ticks.iter().fold(f64::INFINITY, |least, tick| least.min(tick.distance))
}

/// Compares permitted contacts tick by tick, and the smallest distances.
fn assert_never_bolder(what: &str, with: &Run, without: &Run) {
    for (tick, (with, without)) in with.ticks.iter().zip(&without.ticks).enumerate() {
        let (more, less) = (without.contact_speed, with.contact_speed);
        assert!(
            more <= less + 1e-12,
            "without {what}: contact at {more} m/s for {less}, tick {tick}"
        );
    }
    let (nearer, farther) = (least(&without.ticks), least(&with.ticks));
    assert!(nearer > farther - 5e-3, "without {what}: {nearer} m from the person for {farther}");
}

#[test]
fn without_torques_nothing_is_felt_and_nobody_touched() {
    let with = run(6.0, everything, all_torques);
    assert!(with.controller.measures_contacts());
    let fastest = with.ticks.iter().fold(0.0, |most: f64, tick| most.max(tick.contact_speed));
    assert!(fastest > 0.1, "they work together: {fastest} m/s");
    // All torques of the arm are missing, as in an empty list of efforts, or a single one.
    for lost in [3..10, 5..6] {
        let without = run(6.0, everything, |torques| torques[lost.clone()].fill(None));
        assert!(!without.controller.measures_contacts());
        assert!(without.ticks.iter().all(|tick| tick.contact_speed == 0.0));
        assert_eq!(without.controller.external_force().norm(), 0.0, "no force that is not there");
        assert!(without.state() < SafetyState::ProtectiveStop);
        assert_never_bolder("torques", &with, &without);
        // The distances are those to a person who does not work with the robot.
        let separation = without.controller.controller().settings().safety.separation;
        let kept = separation.protective_distance(0.0, 0.0) - 0.05;
        assert!(least(&without.ticks) > kept, "{} m", least(&without.ticks));
    }
}

/// Measurements that begin later count from then on, and only while they come.
#[test]
fn force_limiting_comes_and_goes_with_the_torques() {
    let mut run = Run::new();
    for _ in 0..4000 {
        run.step(&everything, &|torques| torques.fill(None));
    }
    assert!(!run.controller.measures_contacts());
    for _ in 0..1500 {
        run.step(&everything, &all_torques);
    }
    assert!(run.controller.measures_contacts());
    assert!(run.ticks.last().unwrap().contact_speed > 0.1);
    run.step(&everything, &|torques| torques[4] = None);
    assert!(!run.controller.measures_contacts());
    assert_eq!(run.ticks.last().unwrap().contact_speed, 0.0, "at once");
}

type Leave = fn(&mut Percept, f64);

#[test]
fn missing_part_of_frame_never_makes_bolder() {
    let with = run(6.0, everything, all_torques);
    let leave: [(&str, Leave); 4] = [
        ("an action", |percept, _| percept.action = None),
        ("a surface", |percept, _| percept.surface = None),
        ("covariances", |percept, _| {
            let body = percept.body.take().map(|body| Body::new(*body.keypoints()));
            percept.body = body;
        }),
        // These joints were seen before.
        ("the arms", |percept, time| {
            use Body25::{LeftElbow, LeftWrist, RightElbow, RightWrist};
            let body = percept.body.as_mut().filter(|_| time > 2.0);
            let Some(body) = body else { return };
            for joint in [LeftElbow, LeftWrist, RightElbow, RightWrist] {
                body.set(joint, None);
            }
        }),
    ];
    for (what, leave) in leave {
        let without = run(
            6.0,
            |time| {
                let mut percept = everything(time);
                leave(&mut percept, time);
                percept
            },
            all_torques,
        );
        assert_never_bolder(what, &with, &without);
    }
}

/// The robot stands, and only the frames differ. A joint that is not seen any longer leaves no more room.
#[test]
fn lost_joint_never_leaves_more_room() {
    let stands = |time: f64| Percept { action: None, ..everything(time + 2.0) };
    let rooms = |missing: Option<Body25>| -> Vec<Boldness> {
        let settings = ControllerSettings::default();
        let ergonomics =
            ErgonomicsQuadratic::new(Matrix3::identity(), Vector3::zeros(), 1.0).unwrap();
        let mut controller =
            Controller::new(MOCA.clone(), ergonomics, settings, &MOCA_HOME).unwrap();
        let ticks = (0..700_u32).map(|tick| {
            let now = f64::from(tick) * PERIOD;
            if tick.is_multiple_of(FRAME) {
                let mut percept = Percept { time: now, ..stands(now) };
                let gone = missing.filter(|_| now > 0.3);
                if let (Some(body), Some(joint)) = (&mut percept.body, gone) {
                    body.set(joint, None);
                }
                controller.observe(&percept).unwrap();
            }
            controller.step(now, &MOCA_HOME).unwrap();
            let safety = controller.safety();
            Boldness {
                contact_speed: safety.contact_speed(),
                room: safety.nearest().map_or(f64::INFINITY, hrsw_safety::Nearest::room),
                scale: safety.speed_scale(),
                distance: 0.0,
            }
        });
        ticks.collect()
    };
    let with = rooms(None);
    for (joint, _) in JOINTS {
        for (tick, (with, without)) in with.iter().zip(rooms(Some(joint))).enumerate() {
            let (more, less) = (without.room, with.room);
            assert!(
                more <= less + 5e-3,
                "without {}: {more} m for {less}, tick {tick}",
                joint.name()
            );
            assert!(without.scale <= with.scale + 1e-9, "without {}, tick {tick}", joint.name());
        }
    }
}

/// A robot without a status gets the same commands as one whose status is good.
#[test]
fn missing_status_does_not_change_commands() {
    let commands = |status: RobotStatus| -> Vec<JointCommand> {
        let (mut law, frames, mut measured) = loop_controller();
        measured.robot = status;
        let mut command = JointCommand::at_rest(&measured);
        let ticks = (0..500_u32).map(|tick| {
            let now = f64::from(tick) * PERIOD;
            if tick.is_multiple_of(FRAME) {
                frames.try_send(everything(now).into()).unwrap();
            }
            law.step(now, &measured, &mut command).unwrap();
            command.clone()
        });
        ticks.collect()
    };
    let nothing = commands(RobotStatus::default());
    let mode = Some(RobotMode::Running);
    for took_command in [None, Some(true)] {
        assert_eq!(commands(RobotStatus { mode, took_command, holds: None }), nothing);
    }
}
