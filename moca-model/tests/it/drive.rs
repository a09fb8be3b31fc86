//! A robot that drives with a person in the way, and clocks, frames and measurements that may be wrong.

use std::sync::LazyLock;
use std::sync::mpsc::SyncSender;

use ergo_map::ErgonomicsQuadratic;
use hrsw::{Attachment, Capsule};
use hrsw_safety::{Cause, Fault, SafetyState, proximity};
use moca_model::whole_body::control_loop::JointMeasurement;
use moca_model::whole_body::torque::Compensation;
use moca_model::whole_body::{Data, Model};
use moca_model::{
    AnswerDelay, Controller, ControllerSettings, Error, LoopController, MOCA_HOME, Scene,
    SimulatedRobot, TorqueController, TorqueLoopSettings,
};
use nalgebra::{Isometry3, Matrix3, Point3, Vector3};
use vision_models::{
    Action, Body, Body25, Confidence, Keypoint, Percept, PersonId, RecognisedAction,
};

use crate::shared::MOCA;

pub(crate) const PERIOD: f64 = 1e-3;
/// Number of ticks between two camera frames at 20 Hz.
pub(crate) const FRAME: u32 = 50;

/// A standing person whose trunk is at x, seen from the front.
pub(crate) fn body(x: f64) -> Body {
    let mut body = Body::default();
    for (joint, y, z) in [
        (Body25::Neck, 0.0, 1.45),
        (Body25::RightShoulder, 0.2, 1.43),
        (Body25::LeftShoulder, -0.2, 1.43),
        (Body25::MidHip, 0.0, 0.93),
        (Body25::RightHip, 0.12, 0.93),
        (Body25::LeftHip, -0.12, 0.93),
    ] {
        let position = Point3::new(x, y, z);
        body.set(joint, Some(Keypoint { position, confidence: Confidence::ONE }));
    }
    body
}

/// Returns people at these places, each with their own id.
pub(crate) fn others(places: &[f64]) -> Vec<Body> {
    let people = (1..).zip(places);
    people.map(|(number, &x)| body(x).with_id(PersonId::new(number))).collect()
}

pub(crate) fn percept(time: f64, person: Option<f64>) -> Percept {
    doing(Action::Walking, time, person)
}

pub(crate) fn doing(action: Action, time: f64, person: Option<f64>) -> Percept {
    let action = RecognisedAction { action, confidence: Confidence::ONE };
    Percept { time, body: person.map(body), action: Some(action), surface: None }
}

/// Returns a controller that takes frames from another thread, the sender of the frames, and joints at rest. The robot
/// is assumed to respond without delay.
pub(crate) fn loop_controller() -> (LoopController, SyncSender<Scene>, JointMeasurement) {
    loop_controller_of(AnswerDelay::Known(0.0))
}

/// Returns the same for a robot with this response delay.
pub(crate) fn loop_controller_of(
    delay: AnswerDelay,
) -> (LoopController, SyncSender<Scene>, JointMeasurement) {
    let controller = Drive::new().controller;
    let settings = TorqueLoopSettings { delay, ..TorqueLoopSettings::new(Compensation::BARE) };
    let controller = TorqueController::new(controller, settings).unwrap();
    let (law, frames) = LoopController::new(controller);
    let mut measured = JointMeasurement::resting(MOCA_HOME.to_vec(), 10);
    measured.torque.fill(Some(0.0));
    (law, frames, measured)
}

pub(crate) type Clock = fn(f64) -> f64;

/// A robot that drives to a place four metres ahead with default settings, and the true state.
#[derive(Clone)]
pub(crate) struct Drive {
    pub(crate) controller: Controller,
    pub(crate) robot: SimulatedRobot,
    pub(crate) model: Model,
    pub(crate) period: f64,
    pub(crate) tick: u32,
    /// True place of the person, and whether the camera works.
    pub(crate) person: Option<f64>,
    pub(crate) camera: bool,
    /// Places of other people.
    pub(crate) others: Vec<f64>,
    /// Clocks of the ticks and of the camera relative to the true time \[s\].
    pub(crate) clock: Clock,
    pub(crate) stamp: Clock,
    /// The last commanded velocities.
    pub(crate) velocity: Vec<f64>,
}

impl Drive {
    pub(crate) fn new() -> Self {
        Self::with(ControllerSettings::default())
    }

    pub(crate) fn with(settings: ControllerSettings) -> Self {
        let model = MOCA.clone();
        let robot = SimulatedRobot::new(&model, &MOCA_HOME).unwrap();
        let ergonomics =
            ErgonomicsQuadratic::new(Matrix3::identity(), Vector3::zeros(), 1.0).unwrap();
        let period = settings.period;
        let mut controller =
            Controller::new(model.clone(), ergonomics, settings, &MOCA_HOME).unwrap();
        let space = controller.space().workspace();
        let (centre, rotation) = (space.position(), space.world_from_workspace().rotation);
        let middle = (centre.min() + centre.max()) * 0.5;
        let origin = Vector3::new(4.0, 0.0, 1.0) - rotation * middle;
        let place = Isometry3::from_parts(origin.into(), rotation);
        controller.space_mut().assign(Some(Attachment::World(place))).unwrap();
        Self {
            controller,
            robot,
            model,
            period,
            tick: 0,
            person: None,
            camera: true,
            others: Vec::new(),
            clock: |time| time,
            stamp: |time| time,
            velocity: vec![0.0; 10],
        }
    }

    /// The true time \[s\].
    pub(crate) fn time(&self) -> f64 {
        f64::from(self.tick) * self.period
    }

    /// Takes a camera frame of the present scene and returns the controller's result.
    pub(crate) fn see(&mut self) -> Result<(), Error> {
        let percept = percept((self.stamp)(self.time()), self.person);
        self.controller.observe(Scene::from(percept).with_others(&others(&self.others)))
    }

    /// Makes a period with the true configuration as the measurement.
    pub(crate) fn step(&mut self) {
        let measured = self.robot.position().to_vec();
        self.step_with(&measured);
    }

    /// Makes a period with another configuration as the measurement.
    pub(crate) fn step_with(&mut self, measured: &[f64]) {
        if self.camera && self.tick.is_multiple_of(FRAME) {
            let _ = self.see();
        }
        let _ = self.controller.step((self.clock)(self.time()), measured);
        self.obey(self.period);
        self.tick += 1;
    }

    /// Moves the robot as commanded for `time`, within its limits.
    pub(crate) fn obey(&mut self, time: f64) {
        let command = self.controller.command();
        let limits = self.model.limits();
        for ((v, before), limits) in command.joint_velocity.iter().zip(&self.velocity).zip(limits) {
            assert!(v.abs() <= limits.velocity * (1.0 + 1e-9), "{v} at tick {}", self.tick);
            // A robot that has stopped by itself takes no commands.
            let is_told = command.fault != Some(Fault::RobotStopped);
            let change = (v - before).abs();
            assert!(
                !is_told || change <= limits.acceleration * time * (1.0 + 1e-6),
                "{before} to {v} in {time} s at tick {}",
                self.tick
            );
        }
        self.velocity.clone_from(&command.joint_velocity);
        self.robot.step(&command.joint_velocity, time).unwrap();
        assert!(self.distance() > 0.0, "into the person at tick {}", self.tick);
    }

    pub(crate) fn run(&mut self, seconds: f64) {
        let end = self.time() + seconds - 0.5 * self.period;
        while self.time() < end {
            self.step();
        }
    }

    /// Runs with a clock that differs from the true time by `offset` seconds.
    pub(crate) fn go_on(&mut self, offset: f64, seconds: f64) {
        let end = self.time() + seconds - 0.5 * PERIOD;
        while self.time() < end {
            let now = self.time() + offset;
            if self.tick.is_multiple_of(FRAME) {
                let _ = self.controller.observe(percept(now, self.person));
            }
            let measured = self.robot.position().to_vec();
            self.controller.step(now, &measured).unwrap();
            self.obey(PERIOD);
            self.tick += 1;
        }
    }

    /// Returns the robot in fast motion without any person.
    pub(crate) fn fast() -> Self {
        static FAST: LazyLock<Drive> = LazyLock::new(|| {
            let mut drive = Drive::new();
            drive.run(2.5);
            assert!(drive.fastest() > 0.2, "it drives: {}", drive.fastest());
            drive
        });
        FAST.clone()
    }

    /// Returns the robot in fast motion with a person in front of it.
    pub(crate) fn towards_a_person() -> Self {
        let mut drive = Self::fast();
        drive.person = Some(drive.controller.actual().translation.x + 1.8);
        drive
    }

    /// The distance between the true robot and the nearest trunk.
    pub(crate) fn distance(&self) -> f64 {
        let people = self.person.iter().chain(&self.others);
        people.fold(f64::INFINITY, |least, x| least.min(self.distance_to(*x)))
    }

    fn distance_to(&self, x: f64) -> f64 {
        let trunk =
            Capsule::new(Vector3::new(x, 0.0, 0.9), Vector3::new(x, 0.0, 1.5), 0.15).unwrap();
        let mut data = Data::new(&self.model);
        let posed = data.pose(&self.model, self.robot.position()).unwrap();
        let settings = self.controller.settings().safety.bodies.iter();
        let distances = settings.map(|body| {
            let link = self.model.frame_id(&body.link).unwrap();
            let pose = posed.world_from(link).unwrap();
            proximity(&body.capsule.placed(&pose), &trunk).distance
        });
        distances.fold(f64::INFINITY, f64::min)
    }

    /// Asserts that the robot came as near to the person as allowed, or goes around them.
    pub(crate) fn assert_near_but_not_too_near(&self) {
        let separation = self.controller.settings().safety.separation;
        let distance = self.distance();
        assert!(
            distance > separation.protective_distance(0.0, 0.0) && distance < 1.0,
            "{distance}"
        );
    }

    pub(crate) fn fastest(&self) -> f64 {
        self.controller.command().joint_velocity.iter().fold(0.0, |most, v| most.max(v.abs()))
    }

    pub(crate) fn state(&self) -> SafetyState {
        self.controller.safety().supervisor().state()
    }

    pub(crate) fn cause(&self) -> Option<Fault> {
        match self.controller.safety().supervisor().cause() {
            Some(Cause::Fault(fault)) => Some(*fault),
            _ => None,
        }
    }

    pub(crate) fn acknowledge(&mut self) {
        self.controller.safety_mut().supervisor_mut().acknowledge();
    }

    /// Asserts that the robot stands for this reason and waits for an acknowledgement.
    pub(crate) fn assert_waits(&self, fault: Fault) {
        assert_eq!(self.state(), SafetyState::ProtectiveStop);
        assert_eq!(self.cause(), Some(fault));
        assert_eq!(self.controller.safety().supervisor().unacknowledged(), Some(fault));
        assert_eq!(self.fastest(), 0.0);
    }

    /// Acknowledges, and asserts that the robot goes on.
    pub(crate) fn assert_goes_on(&mut self) {
        self.person = self.person.map(|_| 30.0);
        self.acknowledge();
        self.run(2.0);
        assert_eq!(self.state(), SafetyState::Normal);
        assert!(self.fastest() > 0.01, "it moves again: {}", self.fastest());
    }
}
