//! The control path allocates nothing after construction.

use ergo_map::ErgonomicsQuadratic;
use moca_model::whole_body::Data;
use moca_model::whole_body::control_loop::{ControlLaw, JointCommand};
use moca_model::whole_body::torque::{JointImpedance, JointState};
use moca_model::{
    Controller, ControllerSettings, GraspedObject, ImpedanceSettings, Kinematics, MOCA_HOME,
    MOCA_TOOL, Scene, SimulatedRobot, moca, moca_safety,
};
use nalgebra::{Matrix3, Point3, Vector3};
use vision_models::{Action, Body, Body25, Confidence, Keypoint, Percept, RecognisedAction, Tool};

use crate::drive::{Drive, loop_controller, others, percept};

/// The number of allocations of `action` on this thread.
fn allocations(action: impl FnOnce()) -> u64 {
    allocation_counter::measure(action).count_total
}

#[test]
fn the_counter_counts() {
    assert!(allocations(|| drop(std::hint::black_box(vec![1_u8]))) > 0);
}

#[test]
fn kinematics_and_gravity_allocate_nothing() {
    let model = moca().unwrap();
    let mut data = Data::new(&model);
    let mut gravity = [0.0; 10];
    let bodies = moca_safety().bodies;
    let mut robot = Kinematics::new(model.clone(), MOCA_TOOL, &bodies, &MOCA_HOME).unwrap();
    let count = allocations(|| {
        for _ in 0..10 {
            robot.update(&MOCA_HOME).unwrap();
            data.pose(&model, &MOCA_HOME).unwrap().gravity_into(&mut gravity).unwrap();
        }
    });
    assert_eq!(count, 0);
}

#[test]
fn impedance_and_simulation_allocate_nothing() {
    let model = moca().unwrap();
    let mut robot = SimulatedRobot::new(&model, &MOCA_HOME).unwrap();
    let settings = ImpedanceSettings::default();
    let mut impedance = JointImpedance::new(settings, &model.limits()[3..]).unwrap();
    let count = allocations(|| {
        for _ in 0..10 {
            robot.step(&[0.1; 10], 0.001).unwrap();
            let measured =
                JointState { position: &robot.position()[3..], velocity: &robot.velocity()[3..] };
            let desired = JointState { position: &MOCA_HOME[3..], velocity: &[0.0; 7] };
            impedance.torque(desired, measured, &[1.0; 7], 0.001).unwrap();
        }
    });
    assert_eq!(count, 0);
}

#[test]
fn a_tick_of_the_controller_allocates_nothing() {
    let hessian = Matrix3::identity() * 8.0;
    let best = Vector3::new(0.35, -0.1, 1.1);
    let ergonomics = ErgonomicsQuadratic::new(hessian, -(hessian * best), 1.0).unwrap();
    let model = moca().unwrap();
    let settings = ControllerSettings::default();
    let mut robot = SimulatedRobot::new(&model, &MOCA_HOME).unwrap();
    let mut controller = Controller::new(model, ergonomics, settings, &MOCA_HOME).unwrap();
    let mut body = Body::default();
    for (joint, y, z) in [
        (Body25::RightShoulder, 0.2, 1.43),
        (Body25::LeftShoulder, -0.2, 1.43),
        (Body25::RightHip, 0.12, 0.93),
        (Body25::LeftHip, -0.12, 0.93),
        (Body25::MidHip, 0.0, 0.93),
    ] {
        let position = Point3::new(1.4, y, z);
        body.set(joint, Some(Keypoint { position, confidence: Confidence::ONE }));
    }
    controller.grasp(GraspedObject::default()).unwrap();
    let action = RecognisedAction { action: Action::DeliverObject, confidence: Confidence::ONE };
    let mut percept = Percept { time: 0.0, body: Some(body), action: Some(action), surface: None };
    let count = allocations(|| {
        for tick in 0..3000_u32 {
            let now = f64::from(tick) * 1e-3;
            if tick.is_multiple_of(50) {
                percept.time = now;
                if tick == 1500 {
                    let action = Action::Using(Tool::Drill);
                    percept.action = Some(RecognisedAction { action, confidence: Confidence::ONE });
                }
                controller.observe(&percept).unwrap();
            }
            controller.set_external_force(0.0);
            controller.step(now, robot.position()).unwrap();
            robot.step(&controller.command().joint_velocity, 1e-3).unwrap();
        }
    });
    assert_eq!(count, 0);
    assert!(controller.command().joint_velocity.iter().any(|v| v.abs() > 1e-3), "it moves");
}

/// Frames of several people come from another thread and are dropped in the loop. It allocates and frees nothing from
/// the first tick on, with ids of the camera or those that the controller gives.
#[test]
fn frames_of_several_people_allocate_nothing() {
    let with_ids = others(&[6.0, 8.0]);
    let without_ids: Vec<_> = with_ids.iter().map(|body| body.clone().with_id(None)).collect();
    for others in [with_ids, without_ids] {
        let (mut law, frames, measured) = loop_controller();
        let mut command = JointCommand::at_rest(&measured);
        let counted = allocation_counter::measure(|| {
            for tick in 0..200_u32 {
                let now = f64::from(tick) * 1e-3;
                if tick.is_multiple_of(50) {
                    let frame = Scene::from(percept(now, Some(4.0))).with_others(&others);
                    frames.try_send(frame).unwrap();
                }
                law.step(now, &measured, &mut command).unwrap();
            }
        });
        assert_eq!((counted.count_total, counted.count_current), (0, 0));
        let safety = law.controller().controller().safety();
        let of_one = safety.person_bodies().len();
        assert_eq!(safety.all_bodies().len(), 3 * of_one, "two others are known");
    }
}

#[test]
fn a_tick_with_a_fault_allocates_nothing() {
    let mut drive = Drive::new();
    drive.run(1.0);
    let measured = drive.robot.position().to_vec();
    let mut pushed = measured.clone();
    pushed[5] += 1.0;
    let mut broken = measured.clone();
    broken[5] = f64::NAN;
    let mut huge = measured.clone();
    huge[0] = 1e200;
    let frames = [f64::NAN, 1e3, 1e9, 0.95, 0.5].map(|time| percept(time, Some(3.0)));
    let controller = &mut drive.controller;
    let count = allocations(|| {
        for frame in &frames {
            assert!(controller.observe(frame).is_err());
        }
        for (now, q) in [
            (1.0, &measured),
            (1.0, &measured),
            (f64::NAN, &measured),
            (1.001, &broken),
            (1.001, &huge),
            (1.0011, &measured),
            (1.005, &pushed),
            (0.5, &measured),
            (9.0, &measured),
        ] {
            assert!(controller.step(now, q).is_ok());
        }
        assert!(controller.step(9.001, &measured[1..]).is_err());
    });
    assert_eq!(count, 0);
}
