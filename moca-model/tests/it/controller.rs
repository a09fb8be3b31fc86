//! The controller in a loop with the simulated robot and a person who stands, walks or disappears.

use ergo_map::ErgonomicsQuadratic;
use hrsw::HeldFrame;
use hrsw_safety::Fault;
use moca_model::{
    Controller, ControllerSettings, DesiredMotion, Error, Goal, Intention, MOCA_HOME, Outcome,
    SimulatedRobot, SpaceSettings,
};
use nalgebra::{Isometry3, Matrix3, Point3, Vector3};
use proptest::prelude::*;
use vision_models::{
    Action, Body, Body25, Confidence, Keypoint, Percept, RecognisedAction, Tool, WalkingDirection,
};

use crate::shared::MOCA;

const PERIOD: f64 = 1e-3;
/// Number of ticks between two camera frames at 20 Hz.
const FRAME: u32 = 50;

/// Ergonomics with the optimum at (0.35, −0.1, 1.1) in the person's frame.
fn ergonomics() -> ErgonomicsQuadratic {
    let hessian = Matrix3::from_diagonal(&Vector3::new(10.0, 5.0, 7.0));
    let best = Vector3::new(0.42, -0.1, 1.1);
    ErgonomicsQuadratic::new(hessian, -(hessian * best), 0.5 * best.dot(&(hessian * best))).unwrap()
}

fn person_at(x: f64, y: f64, heading: f64) -> Isometry3<f64> {
    Isometry3::new(Vector3::new(x, y, 0.0), Vector3::new(0.0, 0.0, heading))
}

/// A standing body with trunk and shoulders, as the tracker needs them.
fn body(world_from_person: &Isometry3<f64>) -> Body {
    let mut body = Body::default();
    for (joint, x, y, z) in [
        (Body25::Neck, 0.0, 0.0, 1.45),
        (Body25::RightShoulder, 0.0, -0.2, 1.43),
        (Body25::LeftShoulder, 0.0, 0.2, 1.43),
        (Body25::MidHip, 0.0, 0.0, 0.93),
        (Body25::RightHip, 0.0, -0.12, 0.93),
        (Body25::LeftHip, 0.0, 0.12, 0.93),
    ] {
        let position = world_from_person * Point3::new(x, y, z);
        body.set(joint, Some(Keypoint { position, confidence: Confidence::ONE }));
    }
    body
}

fn percept(time: f64, person: &Isometry3<f64>, action: Action) -> Percept {
    let action = Some(RecognisedAction { action, confidence: Confidence::ONE });
    Percept { time, body: Some(body(person)), action, surface: None }
}

struct Loop {
    controller: Controller,
    robot: SimulatedRobot,
    tick: u32,
}

impl Loop {
    fn new(settings: ControllerSettings) -> Self {
        let model = MOCA.clone();
        let robot = SimulatedRobot::new(&model, &MOCA_HOME).unwrap();
        let controller = Controller::new(model, ergonomics(), settings, &MOCA_HOME).unwrap();
        Self { controller, robot, tick: 0 }
    }

    fn now(&self) -> f64 {
        f64::from(self.tick) * PERIOD
    }

    /// Runs for `ticks`. `see` returns the percept at a time, if there is one.
    fn run(&mut self, ticks: u32, see: impl Fn(f64) -> Option<Percept>) {
        for _ in 0..ticks {
            if self.tick.is_multiple_of(FRAME)
                && let Some(percept) = see(self.now())
            {
                let seen = self.controller.observe(&percept);
                // A person who jumps is only accepted from the next frame on.
                assert!(
                    matches!(
                        seen,
                        Ok(()) | Err(Error::Safety(hrsw_safety::Error::BodySpeed { .. }))
                    ),
                    "{seen:?}"
                );
            }
            self.controller.step(self.now(), self.robot.position()).unwrap();
            let command = self.controller.command();
            assert!(command.outcome.is_optimal(), "{:?} at {}", command.outcome, self.now());
            self.robot.step(&command.joint_velocity, PERIOD).unwrap();
            self.tick += 1;
        }
    }

    fn hand_in(&self, person: &Isometry3<f64>) -> Vector3<f64> {
        person
            .inverse_transform_point(&self.controller.command().desired.translation.vector.into())
            .coords
    }
}

#[test]
fn tool_reaches_the_optimum_without_overshoot() {
    let person = person_at(1.3, 0.1, std::f64::consts::PI);
    let mut run = Loop::new(ControllerSettings::default());
    let best = Vector3::new(0.42, -0.1, 1.1);
    run.run(1000, |time| Some(percept(time, &person, Action::Using(Tool::Drill))));
    let mut nearest = (run.hand_in(&person) - best).norm();
    for _ in 0..19_000 {
        run.run(1, |time| Some(percept(time, &person, Action::Using(Tool::Drill))));
        let distance = (run.hand_in(&person) - best).norm();
        assert!(distance < nearest + 1e-4, "moves away: {distance} after {nearest}");
        nearest = nearest.min(distance);
    }
    assert!(nearest < 2e-3, "{nearest} m from the best place");
    let twist = run.controller.command().desired_twist;
    assert!(twist.norm() < 1e-3, "{twist}");
    assert!(run.controller.command().slack.norm() < 1e-6);
    let error = run.controller.command().desired.translation.vector
        - run.controller.actual().translation.vector;
    assert!(error.norm() < 1e-4, "tracking error {}", error.norm());
}

#[test]
fn benchmark_stops_at_the_shared_workspace() {
    let person = person_at(1.5, 0.0, std::f64::consts::PI);
    let settings = ControllerSettings { goal: Goal::LeastMotion, ..ControllerSettings::default() };
    let mut run = Loop::new(settings);
    run.run(8000, |time| Some(percept(time, &person, Action::Using(Tool::Drill))));
    let hand = run.hand_in(&person);
    let far = 0.75 - SpaceSettings::default().margin;
    assert!((hand.x - far).abs() < 5e-3, "stops at the far side: {hand}");
    assert!(run.controller.command().activation == 0.0);
}

#[test]
fn robot_stays_while_person_is_apart() {
    let person = person_at(1.3, 0.0, std::f64::consts::PI);
    let mut run = Loop::new(ControllerSettings::default());
    run.run(3000, |time| Some(percept(time, &person, Action::Walking)));
    assert_eq!(run.controller.command().intention, Intention::Apart);
    for (q, home) in run.robot.position().iter().zip(MOCA_HOME) {
        assert!((q - home).abs() < 1e-9);
    }
}

#[test]
fn tool_follows_walking_person_within_workspace() {
    let speed = 0.25;
    let place =
        |time: f64| person_at(1.3 + speed * (time - 4.0).max(0.0), 0.0, std::f64::consts::PI);
    let mut run = Loop::new(ControllerSettings::default());
    let see = |time: f64| {
        let action = if time < 4.0 {
            Action::Using(Tool::Drill)
        } else {
            Action::MoveWhileUsing(WalkingDirection::Backwards, Tool::Drill)
        };
        Some(percept(time, &place(time), action))
    };
    run.run(6000, see);
    for _ in 0..4000 {
        run.run(1, see);
        let outside =
            run.controller.space().workspace().violation(&run.controller.command().desired);
        assert!(outside.norm() < 1e-3, "{outside}");
    }
    let walking =
        Intention::Together { walking: Some(WalkingDirection::Backwards), tool: Some(Tool::Drill) };
    assert_eq!(run.controller.command().intention, walking);
    assert!((run.controller.command().desired_twist[0] - speed).abs() < 0.05);
}

#[test]
fn robot_rests_while_its_person_is_lost() {
    let place = |time: f64| person_at(1.3 + 0.2 * time, 0.0, std::f64::consts::PI);
    let work = |time: f64| Some(percept(time, &place(time), Action::Using(Tool::Drill)));
    let mut run = Loop::new(ControllerSettings::default());
    run.run(3000, work);
    run.run(4500, |_| None);
    assert!(run.controller.command().joint_velocity.iter().all(|v| v.abs() < 1e-9));
    run.run(4000, |time| work(time.min(4.0)).map(|p| Percept { time, ..p }));
    assert!(
        run.controller.space().workspace().violation(&run.controller.command().desired).norm()
            < 1e-3
    );
}

#[test]
fn jump_of_the_person_is_followed_within_limits() {
    let mut run = Loop::new(ControllerSettings::default());
    let place =
        |time: f64| person_at(1.3, if time < 4.0 { 0.0 } else { 2.0 }, std::f64::consts::PI);
    let limits = MOCA.limits().to_vec();
    let (mut last, mut accelerations) = (vec![0.0; 10], vec![0.0; 10]);
    for _ in 0..12_000 {
        run.run(1, |time| Some(percept(time, &place(time), Action::Using(Tool::Polisher))));
        let joints = run.controller.command().joint_velocity.iter().zip(&last).zip(&limits);
        for (((v, before), limits), acceleration) in joints.zip(&mut accelerations) {
            assert!(v.abs() <= limits.velocity * (1.0 + 1e-9));
            let now = (v - before) / PERIOD;
            assert!(now.abs() <= limits.acceleration * (1.0 + 1e-6));
            assert!((now - *acceleration).abs() <= limits.jerk * PERIOD * (1.0 + 1e-6));
            *acceleration = now;
        }
        last.copy_from_slice(&run.controller.command().joint_velocity);
    }
    let best = Vector3::new(0.42, -0.1, 1.1);
    // The frame is held where it came to rest, within its zone.
    let off = (run.hand_in(&place(10.0)) - best).norm();
    assert!(off < HeldFrame::POSITION + HeldFrame::HEADING * best.norm(), "{off} m");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    /// The base twist is the world velocity in the base's axes at any yaw.
    #[test]
    fn base_twist_is_velocity_in_base_frame(yaw in -3.0..3.0_f64, x in -0.5..0.5_f64) {
        let model = MOCA.clone();
        let mut start = MOCA_HOME;
        (start[0], start[2]) = (x, yaw);
        let mut controller =
            Controller::new(model, ergonomics(), ControllerSettings::default(), &start).unwrap();
        let person = person_at(2.0, 0.5, 3.0);
        let mut robot = SimulatedRobot::new(&MOCA, &start).unwrap();
        let mut fastest = 0.0_f64;
        for tick in 0..600_u32 {
            let now = f64::from(tick) * PERIOD;
            if tick.is_multiple_of(FRAME) {
                controller.observe(percept(now, &person, Action::DeliverObject)).unwrap();
            }
            let yaw = robot.position()[2];
            let command = controller.step(now, robot.position()).unwrap();
            let (v, b) = (&command.joint_velocity, command.base_twist);
            let (sine, cosine) = yaw.sin_cos();
            prop_assert!((cosine * b[0] - sine * b[1] - v[0]).abs() < 1e-12);
            prop_assert!((sine * b[0] + cosine * b[1] - v[1]).abs() < 1e-12);
            prop_assert_eq!(b[2], v[2]);
            fastest = v.iter().take(3).fold(fastest, |most, v| most.max(v.abs()));
            let velocity = v.clone();
            robot.step(&velocity, PERIOD).unwrap();
        }
        prop_assert!(fastest > 1e-2, "the base moves: {fastest}");
    }
}

#[test]
fn bad_settings_and_bad_measurements_are_named() {
    let model = MOCA.clone();
    let make = |settings| Controller::new(model.clone(), ergonomics(), settings, &MOCA_HOME);
    let standard = ControllerSettings::default;
    let short = DesiredMotion { acceleration: 0.5, ..DesiredMotion::default() };
    for (settings, word) in [
        (ControllerSettings { period: 0.0, ..standard() }, "period"),
        (ControllerSettings { horizon: f64::NAN, ..standard() }, "horizon"),
        (ControllerSettings { desired: short, ..standard() }, "horizon"),
        (ControllerSettings { gain: nalgebra::Vector6::repeat(-1.0), ..standard() }, "gain"),
    ] {
        let error = make(settings).unwrap_err();
        assert!(error.to_string().contains(word), "{error}");
    }
    let mut settings = standard();
    settings.posture.gain.pop();
    assert!(matches!(make(settings), Err(Error::Size { got: 9, wanted: 10, .. })));
    let upside_down = SpaceSettings { min: Vector3::repeat(2.0), ..SpaceSettings::default() };
    let error = make(ControllerSettings { space: upside_down, ..standard() }).unwrap_err();
    assert!(matches!(error, Error::Workspace(_)), "{error}");

    let mut controller = make(standard()).unwrap();
    assert!(controller.step(0.0, &[0.0; 9]).is_err());
    let mut broken = MOCA_HOME;
    broken[3] = f64::NAN;
    let command = controller.step(1e-3, &broken).unwrap();
    assert_eq!((command.outcome, command.fault), (Outcome::Braking, Some(Fault::BadMeasurement)));
    let command = controller.step(2e-3, &MOCA_HOME).unwrap();
    assert!(matches!(command.outcome, Outcome::Solved(_)));
    let late = percept(0.002, &person_at(1.0, 0.0, 0.0), Action::Walking);
    controller.observe(&late).unwrap();
    assert!(controller.observe(&Percept { time: 0.001, ..late }).is_err());
}
