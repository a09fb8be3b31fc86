//! Comparison of a tick with all features and a tick without them, by turns in one run.
//!
//! One tick has a person who drills on an object that the robot holds, torques, self-collision, protective distances
//! and contacts with rows for 40 pairs. The other tick is the paper's stack by velocities for the same person.
//! person.
//!
//! Run `cargo bench -p moca-model --bench tick [-- TICKS]`.
//!
//! `everything` or `nothing` after the number runs only one of them, to count its instructions: `valgrind
//! --tool=callgrind --toggle-collect='*TorqueController::step*' …`, or `'*Controller::step*'` for `nothing`. This also
//! counts the first ticks, which are not timed: subtract a run with the number 0.
#![allow(clippy::unwrap_used, clippy::print_stdout, missing_docs)]

use std::time::Instant;

use divan::black_box;
use ergo_map::ErgonomicsQuadratic;
use hrsw_safety::SafetySettings;
use moca_model::whole_body::simulation::RandomSource;
use moca_model::whole_body::torque::Compensation;
use moca_model::{
    Controller, ControllerSettings, DynamicRobot, DynamicRobotSettings, GraspedObject, MOCA_HOME,
    MOCA_TOOL, SimulatedRobot, TorqueController, TorqueLoopSettings, moca, moca_safety,
};
use nalgebra::{Matrix3, Point3, Vector3};
use vision_models::{Action, Body, Body25, Confidence, Keypoint, Percept, RecognisedAction, Tool};

const PERIOD: f64 = 1e-3;
/// Number of ticks between two camera frames.
const FRAME: u32 = 50;
/// Number of first ticks that are not timed. In them work begins, the tool approaches, and memory is used for the first
/// time.
const FIRST: u32 = 5_000;

/// Random numbers of a sensor without noise.
struct Exact;

impl RandomSource for Exact {
    fn normal(&mut self) -> f64 {
        0.0
    }

    fn uniform(&mut self) -> f64 {
        1.0
    }
}

fn controller(safety: SafetySettings) -> Controller {
    let hessian = Matrix3::identity() * 8.0;
    let best = Vector3::new(0.45, -0.1, 1.1);
    let ergonomics = ErgonomicsQuadratic::new(hessian, -(hessian * best), 1.0).unwrap();
    let settings = ControllerSettings { safety, ..ControllerSettings::default() };
    Controller::new(moca().unwrap(), ergonomics, settings, &MOCA_HOME).unwrap()
}

/// The whole body of a person who faces the robot, sways, and drills with the right hand.
fn percept(time: f64) -> Percept {
    let mut body = Body::default();
    let sway = 0.1 * (0.8 * time).sin();
    for (joint, [ahead, right, height]) in [
        (Body25::Nose, [0.1, 0.0, 1.6]),
        (Body25::Neck, [0.0, 0.0, 1.45]),
        (Body25::RightShoulder, [0.0, 0.2, 1.43]),
        (Body25::LeftShoulder, [0.0, -0.2, 1.43]),
        (Body25::RightElbow, [0.1, 0.25, 1.15]),
        (Body25::LeftElbow, [0.0, -0.25, 1.12]),
        (Body25::RightWrist, [0.35, 0.15, 1.12]),
        (Body25::LeftWrist, [0.1, -0.25, 0.9]),
        (Body25::MidHip, [0.0, 0.0, 0.93]),
        (Body25::RightHip, [0.0, 0.12, 0.93]),
        (Body25::LeftHip, [0.0, -0.12, 0.93]),
        (Body25::RightKnee, [0.02, 0.12, 0.5]),
        (Body25::LeftKnee, [0.02, -0.12, 0.5]),
        (Body25::RightAnkle, [0.0, 0.12, 0.1]),
        (Body25::LeftAnkle, [0.0, -0.12, 0.1]),
    ] {
        let position = Point3::new(1.5 - ahead, right + sway, height);
        body.set(joint, Some(Keypoint { position, confidence: Confidence::ONE }));
    }
    let action = Action::Using(Tool::Drill);
    let action = Some(RecognisedAction { action, confidence: Confidence::ONE });
    Percept { time, body: Some(body), action, surface: None }
}

/// A loop that returns the time of its tick \[µs\].
trait Loop {
    fn tick(&mut self, tick: u32) -> f64;
}

struct Everything {
    controller: TorqueController,
    robot: DynamicRobot,
}

impl Everything {
    fn new() -> Self {
        let controller = controller(moca_safety());
        let mut controller =
            TorqueController::new(controller, TorqueLoopSettings::new(Compensation::BARE)).unwrap();
        controller.grasp(GraspedObject::default()).unwrap();
        let settings = DynamicRobotSettings::ideal();
        let model = moca().unwrap();
        let mut robot = DynamicRobot::new(&model, &settings, &MOCA_HOME).unwrap();
        robot.attach(model.frame_id(MOCA_TOOL).unwrap(), &GraspedObject::default()).unwrap();
        robot.measure(&mut Exact).unwrap();
        Self { controller, robot }
    }
}

impl Loop for Everything {
    fn tick(&mut self, tick: u32) -> f64 {
        let Self { controller, robot } = self;
        let now = f64::from(tick) * PERIOD;
        if tick.is_multiple_of(FRAME) {
            controller.observe(&percept(now)).unwrap();
        }
        let begin = Instant::now();
        black_box(controller.step(now, &robot.measured()).unwrap());
        let time = begin.elapsed();
        let (command, torque) = (controller.controller().command(), controller.torque());
        robot.step(command, torque, &[], PERIOD, &mut Exact).unwrap();
        robot.measure(&mut Exact).unwrap();
        time.as_secs_f64() * 1e6
    }
}

struct Nothing {
    controller: Controller,
    robot: SimulatedRobot,
}

impl Nothing {
    fn new() -> Self {
        let controller = controller(moca_safety().off());
        let robot = SimulatedRobot::new(&moca().unwrap(), &MOCA_HOME).unwrap();
        Self { controller, robot }
    }
}

impl Loop for Nothing {
    fn tick(&mut self, tick: u32) -> f64 {
        let Self { controller, robot } = self;
        let now = f64::from(tick) * PERIOD;
        if tick.is_multiple_of(FRAME) {
            controller.observe(&percept(now)).unwrap();
        }
        let begin = Instant::now();
        black_box(controller.step(now, robot.position()).unwrap());
        let time = begin.elapsed();
        robot.step(&controller.command().joint_velocity, PERIOD).unwrap();
        time.as_secs_f64() * 1e6
    }
}

/// The quantile of this share.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "an index of a list"
)]
fn quantile(sorted: &[f64], share: f64) -> f64 {
    sorted[((sorted.len() - 1) as f64 * share).round() as usize]
}

fn main() {
    let mut ticks = 60_000;
    let (mut with, mut without) = (true, true);
    for option in std::env::args().skip(1) {
        match option.as_str() {
            "everything" => without = false,
            "nothing" => with = false,
            number => ticks = number.parse().unwrap_or(ticks),
        }
    }
    let mut loops: Vec<(&str, Box<dyn Loop>, Vec<f64>)> = Vec::new();
    if with {
        loops.push(("everything", Box::new(Everything::new()), Vec::new()));
    }
    if without {
        loops.push(("nothing", Box::new(Nothing::new()), Vec::new()));
    }
    for tick in 0..FIRST + ticks {
        for (_, of, times) in &mut loops {
            let time = of.tick(tick);
            if tick >= FIRST {
                times.push(time);
            }
        }
    }
    println!("{:<12}{:>10}{:>10}{:>10}  [µs]", "", "median", "p99", "p99.9");
    let mut medians = Vec::new();
    for (name, _, times) in &mut loops {
        times.sort_by(f64::total_cmp);
        let [median, p99, p999] = [0.5, 0.99, 0.999].map(|share| quantile(times, share));
        println!("{name:<12}{median:>10.1}{p99:>10.1}{p999:>10.1}");
        medians.push(median);
    }
    if let [with, without] = medians[..] {
        println!("everything takes {:.2} times as long", with / without);
    }
}
