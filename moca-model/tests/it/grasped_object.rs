//! The object between robot and person: the place of the hand, the weight, and refused objects.

use ergo_map::ErgonomicsQuadratic;
use std::f64::consts::{PI, TAU};

use moca_model::whole_body::control_loop::JointMeasurement;
use moca_model::whole_body::torque::Compensation;
use moca_model::whole_body::{Data, Model};
use moca_model::{
    BoxSide, Controller, ControllerSettings, Error, GraspedObject, HandSettings, MOCA_HOME,
    MOCA_URDF, Phase, Reason, SimulatedRobot, TorqueController, TorqueLoopSettings, WorkFace,
    moca_description, moca_safety,
};
use nalgebra::{Isometry3, Matrix3, Point3, Vector3};
use proptest::prelude::*;
use vision_models::{
    Action, Confidence, Percept, RecognisedSurface, Surface, Tool, WalkingDirection,
};

use crate::drive::doing;
use crate::shared::MOCA;

const PERIOD: f64 = 1e-3;
const SIDES: [BoxSide; 6] =
    [BoxSide::Front, BoxSide::Back, BoxSide::Left, BoxSide::Right, BoxSide::Top, BoxSide::Bottom];

fn controller() -> Controller {
    controller_with(None)
}

fn controller_with(on_board_camera: Option<[f64; 3]>) -> Controller {
    let hessian = Matrix3::identity() * 8.0;
    let best = Vector3::new(0.35, -0.1, 1.1);
    let least = 0.5 * best.dot(&(hessian * best));
    let ergonomics = ErgonomicsQuadratic::new(hessian, -(hessian * best), least).unwrap();
    let settings = ControllerSettings { on_board_camera, ..ControllerSettings::default() };
    Controller::new(MOCA.clone(), ergonomics, settings, &MOCA_HOME).unwrap()
}

proptest! {
    #[test]
    fn capsule_contains_box_and_hand_is_outside(
        size in prop::array::uniform3(0.01..0.6_f64).prop_map(Vector3::from),
        place in prop::array::uniform3(-0.3..0.3_f64).prop_map(Vector3::from),
        turn in prop::array::uniform3(-1.5..1.5_f64).prop_map(Vector3::from),
        side in prop::sample::select(&SIDES[..]),
    ) {
        let faces = vec![WorkFace { side, surface: Surface::Smooth }];
        let tool_from_object = Isometry3::new(place, turn);
        let object = GraspedObject { size, tool_from_object, faces, mass: 1.0 };
        let capsule = object.capsule().unwrap();
        for corner in 0..8_u8 {
            let sign = |bit: u8| if corner & bit == 0 { -0.5 } else { 0.5 };
            let corner = size.component_mul(&Vector3::new(sign(1), sign(2), sign(4)));
            let corner = tool_from_object * Point3::from(corner);
            prop_assert!(capsule.signed_distance(&corner.coords) < 1e-9);
        }
        let settings = HandSettings::default();
        let [bare, drill] = [None, Some(Tool::Drill)]
            .map(|tool| object.tool_from_hand(&settings, tool).unwrap());
        prop_assert!(((drill - bare).norm() - settings.drill).abs() < 1e-12);
        // The points are in the object's axes: on the surface, and from there straight outwards.
        let inside = tool_from_object.inverse_transform_point(&bare.into()).coords;
        let beyond = inside.abs() - size * 0.5;
        prop_assert!(beyond.max().abs() < 1e-12 && beyond.iter().filter(|b| b.abs() < 1e-12).count() == 1);
        let out = tool_from_object.inverse_transform_vector(&(drill - bare));
        prop_assert!(out.normalize().dot(&inside.normalize()) > 1.0 - 1e-12);
    }
}

/// The robot stays behind the drill, and its wrist rotates about the hand.
#[test]
fn hand_follows_walking_person_with_drill() {
    let mut controller = controller();
    controller.grasp(GraspedObject::default()).unwrap();
    let mut robot = SimulatedRobot::new(&MOCA, &MOCA_HOME).unwrap();
    let mut data = Data::new(&MOCA);
    for tick in 0..9000_u32 {
        let now = f64::from(tick) * PERIOD;
        if tick.is_multiple_of(50) {
            let (x, action) = if now < 5.0 {
                (1.6, Action::Using(Tool::Drill))
            } else {
                let backwards = WalkingDirection::Backwards;
                (1.6 + 0.15 * (now - 5.0), Action::MoveWhileUsing(backwards, Tool::Drill))
            };
            controller.observe(doing(action, now, Some(x))).unwrap();
        }
        controller.set_external_force(0.0);
        controller.step(now, robot.position()).unwrap();
        let pose = data.pose(&MOCA, robot.position()).unwrap();
        let tool = pose.world_from(controller.robot().tool()).unwrap();
        let hand = (tool * Point3::from(*controller.robot().tool_from_hand())).coords;
        assert!((controller.actual().translation.vector - hand).norm() < 1e-12);
        // x_d and the hand stay together, since the wrist rotates about the hand and not about the tool.
        let behind = (controller.command().desired.translation.vector - hand).norm();
        assert!(behind < 5e-4, "{behind} m at {now} s");
        let velocity = controller.command().joint_velocity.clone();
        robot.step(&velocity, PERIOD).unwrap();
    }
    let along = controller.robot().tool_from_hand();
    assert!((along - Vector3::new(0.26, 0.0, 0.05)).norm() < 1e-12, "{along}");
    assert!(controller.command().joint_velocity[0] > 0.05, "it follows");
}

#[test]
fn without_a_measured_force_nobody_may_be_touched() {
    for measures_force in [true, false] {
        let mut controller = controller();
        for tick in 0..2000_u32 {
            let now = f64::from(tick) * PERIOD;
            if tick.is_multiple_of(50) {
                controller.observe(doing(Action::Using(Tool::Drill), now, Some(1.6))).unwrap();
            }
            if measures_force {
                controller.set_external_force(0.0);
            }
            controller.step(now, &MOCA_HOME).unwrap();
        }
        assert_eq!(controller.safety().contact_speed() > 0.0, measures_force);
    }
}

/// The supporting torques are m g times the rise of its middle by each joint.
#[test]
fn the_arm_carries_what_it_holds() {
    let settings = TorqueLoopSettings::new(Compensation::BARE);
    let mut held = TorqueController::new(controller(), settings.clone()).unwrap();
    let mut empty = TorqueController::new(controller(), settings).unwrap();
    let object = GraspedObject { mass: 1.5, ..GraspedObject::default() };
    held.grasp(object.clone()).unwrap();
    let mut measured = JointMeasurement::resting(MOCA_HOME.to_vec(), 10);
    measured.torque.fill(Some(0.0));
    // The torque rate is limited.
    for tick in 0..200_u32 {
        for controller in [&mut held, &mut empty] {
            controller.step(f64::from(tick) * PERIOD, &measured).unwrap();
        }
    }
    let mut data = Data::new(&MOCA);
    let tool = held.controller().robot().tool();
    let middle = Point3::from(object.tool_from_object.translation.vector);
    for joint in 0..7 {
        let mut height = |step: f64| {
            let mut q = MOCA_HOME;
            q[3 + joint] += step;
            (data.pose(&MOCA, &q).unwrap().world_from(tool).unwrap() * middle).z
        };
        let lifts = (height(1e-6) - height(-1e-6)) / 2e-6;
        let difference = held.torque()[joint] - empty.torque()[joint];
        assert!((difference - 1.5 * 9.81 * lifts).abs() < 1e-3, "joint {joint}: {difference}");
    }
    assert_eq!(held.release().unwrap(), Some(object));
    assert_eq!(held.controller().object(), None);
}

#[test]
fn invalid_objects_are_named_and_change_nothing() {
    let mut controller = controller();
    controller.grasp(GraspedObject::default()).unwrap();
    let nan = Isometry3::translation(f64::NAN, 0.0, 0.0);
    let face = |side, surface| WorkFace { side, surface };
    let twice = vec![
        face(BoxSide::Front, Surface::Drilled),
        face(BoxSide::Back, Surface::Smooth),
        face(BoxSide::Back, Surface::Drilled),
    ];
    for (object, name) in [
        (GraspedObject { mass: 0.0, ..GraspedObject::default() }, "object.mass"),
        (GraspedObject { mass: f64::NAN, ..GraspedObject::default() }, "object.mass"),
        (
            GraspedObject { size: Vector3::new(0.1, -0.1, 0.1), ..GraspedObject::default() },
            "object.size",
        ),
        (GraspedObject { tool_from_object: nan, ..GraspedObject::default() }, "tool_from_object"),
        (GraspedObject { faces: Vec::new(), ..GraspedObject::default() }, "face"),
        (GraspedObject { faces: twice, ..GraspedObject::default() }, "Back"),
    ] {
        let error = controller.grasp(object).unwrap_err();
        assert!(error.to_string().contains(name), "{error}");
        assert_eq!(controller.object(), Some(&GraspedObject::default()));
    }
    for hand in [
        HandSettings { drill: -0.1, ..HandSettings::default() },
        HandSettings { polisher: f64::NAN, ..HandSettings::default() },
    ] {
        let settings = ControllerSettings { hand, ..ControllerSettings::default() };
        assert!(matches!(settings.validate(), Err(Error::Value { .. })));
    }
}

/// Returns the angle by which the tool turns about the vertical to show the far side of the object, and its angle
/// before \[rad\]. The person uses a hand tool for that side. The robot's wrist is `turned` from home, and its base has
/// `room` to turn either way.
fn half_turn(turned: f64, room: f64) -> (f64, f64) {
    let mut description = moca_description();
    for (_, limits) in description.limits.iter_mut().filter(|(joint, _)| joint == "base_yaw") {
        limits.position = Some((-room, room));
    }
    let model = Model::from_urdf(MOCA_URDF, &description).unwrap();
    let best = Vector3::new(0.4, -0.1, 1.1);
    let ergonomics =
        ErgonomicsQuadratic::new(Matrix3::identity(), -best, 0.5 * best.norm_squared()).unwrap();
    let mut start = MOCA_HOME;
    start[9] -= turned;
    let mut settings =
        ControllerSettings { safety: moca_safety().off(), ..ControllerSettings::default() };
    settings.posture.configuration = start.to_vec();
    let mut controller = Controller::new(model.clone(), ergonomics, settings, &start).unwrap();
    controller.grasp(GraspedObject::default()).unwrap();
    let mut robot = SimulatedRobot::new(&model, &start).unwrap();
    let mut data = Data::new(&model);
    let mut yaw = |q: &[f64]| {
        let tool = data.pose(&model, q).unwrap().world_from(controller.robot().tool()).unwrap();
        let x = tool * Vector3::x();
        x.y.atan2(x.x)
    };
    let (mut way, mut before, mut first) = (0.0, yaw(&start), None);
    let mut controller = controller.clone();
    for tick in 0..10_000_u32 {
        let now = f64::from(tick) * PERIOD;
        if tick.is_multiple_of(50) {
            let tool = if now < 3.0 { Tool::Drill } else { Tool::Polisher };
            controller.observe(doing(Action::Using(tool), now, Some(0.8))).unwrap();
        }
        controller.set_external_force(0.0);
        controller.step(now, robot.position()).unwrap();
        robot.step(&controller.command().joint_velocity, PERIOD).unwrap();
        let yaw = yaw(robot.position());
        if now > 3.0 {
            first.get_or_insert(before);
            way += (yaw - before + PI).rem_euclid(TAU) - PI;
        }
        before = yaw;
    }
    assert_eq!(controller.command().phase, Phase::Working, "from {turned}");
    assert_eq!(controller.shown(), BoxSide::Back, "from {turned}");
    (way, first.unwrap())
}

/// A half turn goes the shorter way, if the wrist can or the base can help.
#[test]
fn half_turn_goes_shorter_way_if_possible() {
    for turned in [-0.25, -0.1, 0.1, 0.25_f64] {
        let (way, first) = half_turn(turned, f64::INFINITY);
        assert_eq!(way.signum(), first.signum(), "from {first}: {way}");
        // The turn goes from its place to the edge of the room for orientations, 0.35 rad.
        assert!(way.abs() < PI - 0.3, "from {turned}: {way}");
        // The wrist alone has room only for that way.
        let (way, _) = half_turn(turned, 0.3);
        assert!(way > 0.0 && way < PI, "from {turned}: {way}");
    }
}

/// The cosine of the angle between the normal of the side nearest to the camera and the direction to the camera. It
/// only depends on the configuration.
fn facing(q: &[f64], object: &GraspedObject, camera: [f64; 3]) -> f64 {
    let mut data = Data::new(&MOCA);
    let posed = data.pose(&MOCA, q).unwrap();
    let base = Isometry3::new(Vector3::new(q[0], q[1], 0.0), Vector3::z() * q[2]);
    let tool = posed.world_from(MOCA.frame_id(moca_model::MOCA_TOOL).unwrap()).unwrap();
    let middle = (tool * object.tool_from_object).translation.vector;
    let way = (base * Point3::from(camera)).coords - middle;
    let cosines = object.faces.iter().map(|face| {
        let normal = tool.rotation * object.tool_from_object.rotation * face.side.normal();
        normal.dot(&way) / way.norm()
    });
    cosines.fold(-1.0, f64::max)
}

/// The object is held with an edge to the camera. It is turned until a side is seen, and then back.
#[test]
fn unseen_object_turns_to_camera_while_idle() {
    let camera = [0.6, 3.0, 1.1];
    let object = GraspedObject::default();
    for eye in [Some(camera), None] {
        let mut controller = controller_with(eye);
        controller.grasp(object.clone()).unwrap();
        let mut robot = SimulatedRobot::new(&MOCA, &MOCA_HOME).unwrap();
        assert!(facing(&MOCA_HOME, &object, camera) < 0.3);
        let (mut best, mut phases) = (0.0_f64, Vec::new());
        for tick in 0..8000_u32 {
            let now = f64::from(tick) * PERIOD;
            if tick.is_multiple_of(50) {
                // The network is slow, but sees the true surface.
                let seen = now > 3.0 && facing(robot.position(), &object, camera) >= 0.5;
                let confidence = Confidence::new(0.9).unwrap();
                let surface =
                    seen.then_some(RecognisedSurface { surface: Surface::Drilled, confidence });
                let percept = Percept { time: now, body: None, action: None, surface };
                controller.observe(&percept).unwrap();
            }
            controller.step(now, robot.position()).unwrap();
            phases.extend(controller.command().transition.map(|t| (t.from, t.to, t.reason)));
            let velocity = controller.command().joint_velocity.clone();
            robot.step(&velocity, PERIOD).unwrap();
            best = best.max(facing(robot.position(), &object, camera));
        }
        // The workspace is as before.
        let goal = controller.space().moving().reference_goal();
        assert!(goal.angle_to(&controller.settings().space.tool) < 1e-9);
        if eye.is_none() {
            assert!(phases.is_empty() && best < 0.3, "{phases:?} {best}");
            continue;
        }
        assert_eq!(
            phases,
            [
                (Phase::Apart, Phase::Looking, Reason::Hidden),
                (Phase::Looking, Phase::Apart, Reason::Seen)
            ]
        );
        assert!(best >= 0.5, "{best}");
    }
}
