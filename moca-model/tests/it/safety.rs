//! The controller keeps its distance from people, and its bodies contain the robot.

use std::f64::consts::TAU;

use ergo_map::ErgonomicsQuadratic;
use hrsw::Attachment;
use hrsw_safety::{Cause, LinkCapsule, PersonBody, SafetySettings, SafetyState};
use moca_model::{Controller, ControllerSettings, Error, MOCA_HOME, SimulatedRobot};
use moca_model::{moca_safety, whole_body};
use nalgebra::{Isometry3, Matrix3, Vector3};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use vision_models::{Action, Body25, Confidence, Keypoint, Percept, RecognisedAction};

use crate::drive::body;
use crate::shared::MOCA;

const PERIOD: f64 = 1e-3;

struct Loop {
    controller: Controller,
    robot: SimulatedRobot,
    tick: u32,
}

impl Loop {
    fn new() -> Self {
        let model = MOCA.clone();
        let robot = SimulatedRobot::new(&model, &MOCA_HOME).unwrap();
        let ergonomics =
            ErgonomicsQuadratic::new(Matrix3::identity(), Vector3::zeros(), 1.0).unwrap();
        let settings = ControllerSettings::default();
        let controller = Controller::new(model, ergonomics, settings, &MOCA_HOME).unwrap();
        Self { controller, robot, tick: 0 }
    }

    /// Makes a period with a person whose trunk is at x, or nobody in the frame. The intention stays apart.
    fn step(&mut self, person: Option<f64>) {
        let now = f64::from(self.tick) * PERIOD;
        if self.tick.is_multiple_of(50) {
            let action = RecognisedAction { action: Action::Walking, confidence: Confidence::ONE };
            let body = person.map(body);
            let percept = Percept { time: now, body, action: Some(action), surface: None };
            self.controller.observe(&percept).unwrap();
        }
        self.controller.step(now, self.robot.position()).unwrap();
        let command = self.controller.command();
        assert!(command.outcome.is_optimal(), "{:?}", command.outcome);
        self.robot.step(&command.joint_velocity, PERIOD).unwrap();
        self.tick += 1;
    }

    /// Moves the workspace so that the tool is wanted at x.
    fn ask(&mut self, x: f64) {
        let space = self.controller.space().workspace();
        let (centre, rotation) = (space.position(), space.world_from_workspace().rotation);
        let middle = (centre.min() + centre.max()) * 0.5;
        let tool = Vector3::new(x, 0.0, 1.0);
        let origin = tool - rotation * middle;
        let pose = Isometry3::from_parts(origin.into(), rotation);
        self.controller.space_mut().assign(Some(Attachment::World(pose))).unwrap();
    }

    fn least_distance(&self) -> f64 {
        let safety = self.controller.safety();
        let pairs = self.controller.robot().bodies().iter().flat_map(|robot| {
            let person = safety.person_bodies().iter();
            person.map(|part| hrsw_safety::proximity(&robot.capsule, &part.capsule).distance)
        });
        pairs.fold(f64::INFINITY, f64::min)
    }
}

#[test]
fn a_person_in_the_way_is_not_touched() {
    let mut run = Loop::new();
    for _ in 0..1500 {
        run.step(Some(2.5));
    }
    run.ask(4.0);
    let settings = moca_safety().separation;
    for _ in 0..12_000 {
        run.step(Some(2.5));
        assert!(run.least_distance() > settings.protective_distance(0.0, 0.0) - 0.01);
    }
    let moved = run.robot.position()[0];
    assert!(moved > 0.3, "it goes as near as it may: {moved}");
    assert!(run.controller.command().joint_velocity.iter().all(|v| v.abs() < 0.05));
}

/// The place of a hand follows from elbow and wrist, so that it is less certain than these.
#[test]
fn hand_is_less_certain_than_arm_joints() {
    let (elbow, wrist) = (Vector3::new(2.0, 0.25, 1.1), Vector3::new(1.8, 0.15, 1.15));
    let mut run = Loop::new();
    let mut seen = body(2.1);
    for (joint, place) in [(Body25::RightElbow, elbow), (Body25::RightWrist, wrist)] {
        let confidence = Confidence::ONE;
        seen.set(joint, Some(Keypoint { position: place.into(), confidence }));
    }
    let percept = Percept { time: 0.0, body: Some(seen), action: None, surface: None };
    run.controller.observe(&percept).unwrap();
    run.controller.step(0.0, run.robot.position()).unwrap();
    let parts = run.controller.safety().person_bodies();
    let arm = parts.iter().filter(|part| (part.capsule.start() - elbow).norm() < 1e-9);
    let forearm = arm.max_by(|a, b| a.uncertainty.total_cmp(&b.uncertainty)).unwrap();
    let known = |part: &&PersonBody| part.uncertainty == 0.0;
    assert!(parts.iter().filter(known).count() > 3, "the trunk goes from joint to joint");

    let mut draw = ChaCha8Rng::seed_from_u64(1);
    let mut error = || Vector3::from_fn(|_, _| 1e-3 * draw.random_range(-1.0..1.0_f64));
    let (mut of_joint, mut of_hand) = (0.0, 0.0);
    for _ in 0..20_000 {
        let (e, w) = (error(), error());
        let hand =
            |elbow: Vector3<f64>, wrist: Vector3<f64>| wrist + (wrist - elbow).normalize() * 0.15;
        of_joint += w.norm_squared();
        of_hand += (hand(elbow + e, wrist + w) - hand(elbow, wrist)).norm_squared();
    }
    let known = moca_safety().separation.human_uncertainty;
    let farther = f64::sqrt(of_hand / of_joint) - 1.0;
    // The uncertainty along the forearm is smaller, since there the hand has only the error of the wrist.
    let counted = forearm.uncertainty / known;
    assert!(counted > farther && counted < 1.5 * farther, "{counted}, {farther}");
}

#[test]
fn suddenly_visible_person_stops_the_robot() {
    let mut run = Loop::new();
    run.step(None);
    run.ask(4.0);
    for _ in 0..2500 {
        run.step(None);
    }
    let x = run.controller.actual().translation.x;
    let speed = run.controller.command().joint_velocity[0];
    assert!(speed > 0.2, "{speed}");
    let limits = MOCA.limits().to_vec();
    while run.controller.command().safety == SafetyState::Normal {
        run.step(Some(x + 0.6));
    }
    assert!(matches!(run.controller.safety().supervisor().cause(), Some(Cause::TooClose(_))));
    let before = run.controller.command().joint_velocity.clone();
    for tick in 1..100 {
        run.step(Some(x + 0.6));
        let now = &run.controller.command().joint_velocity;
        for ((now, before), limits) in now.iter().zip(&before).zip(&limits) {
            // Reversing the acceleration at the jerk limit and letting it fade takes 2.5 a/j.
            let (a, j) = (limits.acceleration, limits.jerk);
            let late = if j.is_finite() { 3.0 * a / j + PERIOD } else { 0.0 };
            let left = (before.abs() - a * (f64::from(tick) * PERIOD - late).max(0.0)).max(0.0);
            assert!(now.abs() <= left + 1e-9, "brakes as fast as it can: {before} {now}");
        }
    }
}

#[test]
fn without_frames_the_robot_stops() {
    let mut run = Loop::new();
    run.step(None);
    run.ask(2.0);
    for _ in 0..500 {
        run.step(None);
    }
    assert!(run.controller.command().joint_velocity.iter().any(|v| v.abs() > 0.01));
    for _ in 0..2500 {
        let now = f64::from(run.tick) * PERIOD;
        run.controller.step(now, run.robot.position()).unwrap();
        run.robot.step(&run.controller.command().joint_velocity, PERIOD).unwrap();
        run.tick += 1;
    }
    assert_eq!(run.controller.command().safety, SafetyState::ProtectiveStop);
    assert!(matches!(run.controller.safety().supervisor().cause(), Some(Cause::Stale { .. })));
    assert!(run.controller.command().joint_velocity.iter().all(|v| v.abs() < 1e-9));
}

/// Every point of the chassis' faces except the inside of the deck is in a capsule.
#[test]
fn the_capsules_hold_the_chassis() {
    let bodies = moca_safety().bodies;
    let chassis: Vec<_> = bodies.iter().filter(|body| body.link == "base_link").collect();
    let (x, y) = (0.3595, 0.2893);
    for i in 0..=20_i32 {
        for j in 0..=20_i32 {
            let (along, up) = (f64::from(i) / 10.0 - 1.0, -0.061 + 0.4431 * f64::from(j) / 20.0);
            for point in [(x, along * y), (-x, along * y), (along * x, y), (along * x, -y)] {
                let point = Vector3::new(point.0, point.1, up);
                let inside =
                    chassis.iter().any(|body| body.capsule.signed_distance(&point) <= 1e-3);
                assert!(inside, "{point} in base_link");
            }
        }
    }
}

#[test]
fn bad_safety_settings_are_named() {
    let model = MOCA.clone();
    let ergonomics = ErgonomicsQuadratic::new(Matrix3::identity(), Vector3::zeros(), 1.0).unwrap();
    let make = |safety| {
        let settings = ControllerSettings { safety, ..ControllerSettings::default() };
        Controller::new(model.clone(), ergonomics, settings, &MOCA_HOME).unwrap_err()
    };
    let standard = moca_safety;
    let error = make(SafetySettings { contact_speed: f64::NAN, ..standard() });
    assert!(error.to_string().contains("contact_speed"), "{error}");
    let capsule = hrsw_safety::Capsule::sphere(Vector3::zeros(), 0.1).unwrap();
    let foreign = LinkCapsule { link: "tail".into(), capsule };
    let error = make(SafetySettings { bodies: vec![foreign], own_pairs: vec![], ..standard() });
    let unknown = |error: &Error| matches!(error, Error::Robot(whole_body::Error::UnknownName { name, .. }) if name == "tail");
    assert!(unknown(&error), "{error}");
    let error = make(SafetySettings { own_pairs: vec![(0, 99)], ..standard() });
    assert!(error.to_string().contains("99"), "{error}");
    let mut controller =
        Controller::new(model.clone(), ergonomics, ControllerSettings::default(), &MOCA_HOME)
            .unwrap();
    // A prism with this number of sides has two faces more, and the box has six.
    let mut change_to_prism = |sides: u32| {
        let corner = |index| {
            let angle = f64::from(index) * TAU / f64::from(sides);
            [-0.1, 0.1].map(|z| Vector3::new(0.1 * angle.cos(), 0.1 * angle.sin(), z))
        };
        let corners: Vec<_> = (0..sides).flat_map(corner).collect();
        let prism = hrsw::Polytope::hull(&corners).unwrap();
        controller.space_mut().reshape_position(&prism.into(), 1.0)
    };
    let error = change_to_prism(13).unwrap_err();
    assert!(error.to_string().contains("21"), "{error}");
    assert!(change_to_prism(12).is_ok());
}
