//! The rows of each task are the derivative of what it controls.

use nalgebra::{Isometry3, Point3, Translation3, Unit, UnitQuaternion, Vector3, Vector6};
use proptest::prelude::*;
use whole_body::tasks::{
    Axis, AxisTask, CentreOfMassTask, Feedback, FrameTask, JointCouplingTask, ManipulabilityTask,
    OrientationTask, PoseAxes, PositionTask, PostureTask, RelativeFrameTask,
};
use whole_body::{Axes, Data, Model, Task};

use crate::support::stacks::{humanoid, panda, rows_at, two_arms};
use crate::support::{Kind, State, after, last_frame, pose, robots_of, states};

const STEP: f64 = 1e-5;
const GAIN: f64 = 10.0;
const FEEDBACK: Feedback = Feedback { gain: GAIN, deceleration: f64::INFINITY };

/// Checks a task whose target is at the robot's state: its right-tool side decreases at the rate gain · A q̇.
fn is_derivative<T: Task + Clone>(model: &Model, task: &T, state: &State, tolerance: f64) {
    let [before, now, later] = [-STEP, 0.0, STEP]
        .map(|time| rows_at(model, task.clone(), &after(model, &state.q, &state.v, time)));
    assert_eq!(now.len(), task.dimension(model));
    for ((before, now), later) in before.iter().zip(&now).zip(&later) {
        let rate: f64 = now.0.iter().zip(&state.v).map(|(a, v)| a * v).sum();
        let slope = (later.1 - before.1) / (2.0 * STEP);
        assert!((slope + GAIN * rate).abs() < tolerance, "{slope} for {}", -GAIN * rate);
    }
}

fn moves(model: &Model) -> bool {
    model.moved_by(last_frame(model)).unwrap().next().is_some()
}

const KINDS: &[Kind] =
    &[Kind::Fixed, Kind::Prismatic, Kind::Revolute, Kind::Continuous, Kind::Mimic];
const UNREPEATED: &[Kind] = &[Kind::Fixed, Kind::Prismatic, Kind::Revolute, Kind::Continuous];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn of_frames((robot, state) in robots_of(KINDS).prop_flat_map(states)) {
        let model = robot.model();
        prop_assume!(moves(&model));
        let frame = last_frame(&model);
        let now = pose(&model, &state.q, frame);

        let mut position = PositionTask::new(frame).with_feedback(FEEDBACK).with_axes(&[Axis::X, Axis::Z]);
        position.set_target(Point3::from(now.translation.vector)).unwrap();
        is_derivative(&model, &position, &state, 1e-4);

        let mut orientation = OrientationTask::new(frame).with_feedback(FEEDBACK).with_axes(&[Axis::Y]);
        orientation.set_target(now.rotation).unwrap();
        is_derivative(&model, &orientation, &state, 1e-4);

        for axes in [Axes::World, Axes::Local] {
            let coordinates = PoseAxes::new(&[0, 2, 3, 4]).unwrap();
            let mut task = FrameTask::new(frame)
                .with_feedback(FEEDBACK, FEEDBACK)
                .with_coordinates(coordinates, axes);
            task.set_target(now).unwrap();
            is_derivative(&model, &task, &state, 1e-4);
        }

        let own = Unit::new_normalize(Vector3::new(0.3, -0.5, 0.8));
        let mut axis = AxisTask::new(frame, own).with_feedback(FEEDBACK);
        axis.set_target(now.rotation * own).unwrap();
        is_derivative(&model, &axis, &state, 1e-4);
    }

    #[test]
    fn of_relative_frames((robot, state) in robots_of(KINDS).prop_flat_map(states)) {
        let model = robot.model();
        let frames: Vec<_> = model.frames().map(|(frame, _)| frame).collect();
        let (one, other) = (frames[frames.len() / 2], last_frame(&model));
        let apart = Data::new(&model).pose(&model, &state.q).unwrap().relative_pose(one, other).unwrap();
        let mut task = RelativeFrameTask::new(one, other).with_feedback(FEEDBACK, FEEDBACK);
        task.set_target(apart).unwrap();
        prop_assume!(task.validate(&model).is_ok());
        is_derivative(&model, &task, &state, 1e-4);
    }

    #[test]
    fn of_joints_and_masses((robot, state) in robots_of(KINDS).prop_flat_map(states)) {
        let model = robot.model();
        let mut centre = CentreOfMassTask::new(&model).with_feedback(FEEDBACK);
        centre.set_target(Data::new(&model).pose(&model, &state.q).unwrap().centre_of_mass()).unwrap();
        is_derivative(&model, &centre, &state, 1e-4);

        let mut posture = PostureTask::new().with_feedback(FEEDBACK);
        posture.set_target(&state.q).unwrap();
        if posture.dimension(&model) > 0 {
            is_derivative(&model, &posture, &state, 1e-6);
        }

        let single = model.joints().iter().zip(model.joint_ids());
        let joints: Vec<_> = single
            .filter(|(joint, _)| joint.kind.velocities() == 1)
            .zip([1.0, -0.5, 0.7])
            .map(|((_, id), factor)| (id, factor))
            .collect();
        let coupling = JointCouplingTask::new(&joints).with_feedback(FEEDBACK);
        is_derivative(&model, &coupling, &state, 1e-6);
    }

    #[test]
    fn of_manipulability((robot, state) in robots_of(UNREPEATED).prop_flat_map(states)) {
        let model = robot.model();
        prop_assume!(moves(&model));
        for coordinates in [PoseAxes::POSITION, PoseAxes::new(&[0, 4]).unwrap()] {
            let task = ManipulabilityTask::new(last_frame(&model), 0.1)
                .with_coordinates(coordinates)
                .with_gain(GAIN);
            let rows = rows_at(&model, task.clone(), &state.q);
            // The robot must not be close to singular, where w has a kink.
            prop_assume!(0.1 - rows[0].1 / GAIN > 1e-3);
            is_derivative(&model, &task, &state, 1e-3);
        }
    }
}

#[test]
fn manipulability_is_the_root_of_the_determinant() {
    let model = panda();
    let q = [0.1, -0.7, 0.2, -2.0, 0.3, 1.5, 0.6];
    let tool = model.frame_id("panda_hand_tcp").unwrap();
    let task = ManipulabilityTask::new(tool, 0.5).with_coordinates(PoseAxes::ALL).with_gain(1.0);
    let jacobian = crate::support::jacobian(&model, &q, tool, Axes::World);
    let singular_values = jacobian.svd(false, false).singular_values;
    let expected: f64 = singular_values.iter().product();
    let found = 0.5 - rows_at(&model, task, &q)[0].1;
    assert!((found - expected).abs() < 1e-5 * expected, "{found} for {expected}");
}

/// Far targets are checked by formulas of their own.
#[test]
fn errors_are_differences_in_the_stated_axes() {
    let model = humanoid();
    let tool = model.frame_id("left_hand").unwrap();
    let mut q = model.neutral();
    let moves: Vec<f64> = (0..model.velocity_count()).map(|i| 0.1 + 0.01 * i as f64).collect();
    model.integrate(&mut q, &moves).unwrap();
    let now = pose(&model, &q, tool);
    let turn = Vector3::new(0.3, -0.2, 0.5);
    let shift = Vector3::new(0.1, 0.2, -0.3);
    let target = Isometry3::from_parts(
        Translation3::from(now.translation.vector + shift),
        UnitQuaternion::from_scaled_axis(turn) * now.rotation,
    );
    let twist = Vector6::new(1.0, 2.0, 3.0, 4.0, 5.0, 6.0);
    let mut task = FrameTask::new(tool).with_feedback(FEEDBACK, FEEDBACK);
    task.set_moving_target(target, twist).unwrap();
    let expected: Vec<f64> =
        shift.iter().chain(&turn).zip(&twist).map(|(error, twist)| GAIN * error + twist).collect();
    for (row, expected) in rows_at(&model, task.clone(), &q).iter().zip(&expected) {
        assert!((row.1 - expected).abs() < 1e-9 && row.1 == row.2);
    }
    // The same pose in the axes of the tool.
    let task = task.with_coordinates(PoseAxes::ALL, Axes::Local);
    let rows = rows_at(&model, task, &q);
    for part in [0, 3] {
        let world = Vector3::from_row_slice(&expected[part..part + 3]);
        let local = now.rotation.inverse() * world;
        for (row, expected) in rows[part..].iter().zip(&local) {
            assert!((row.1 - expected).abs() < 1e-9);
        }
    }
}

#[test]
fn axis_turns_the_shorter_way() {
    let model = two_arms();
    let head = model.frame_id("head").unwrap();
    let q = model.neutral();
    let mut task = AxisTask::new(head, Vector3::x_axis()).with_feedback(FEEDBACK);
    task.set_target(Vector3::y_axis()).unwrap();
    let rows = rows_at(&model, task.clone(), &q);
    let speed = rows.iter().map(|row| row.1 * row.1).sum::<f64>().sqrt();
    assert!((speed - GAIN * std::f64::consts::FRAC_PI_2).abs() < 1e-9);
    // The rotation is about the world's z axis, as that of neck_yaw.
    let yaw = model.joint(model.joint_id("neck_yaw").unwrap()).unwrap().velocity_index;
    let turned: f64 = rows.iter().map(|row| row.0[yaw] * row.1).sum();
    assert!((turned - speed).abs() < 1e-9);
    task.set_target(-Vector3::x_axis()).unwrap();
    let rows = rows_at(&model, task, &q);
    let speed = rows.iter().map(|row| row.1 * row.1).sum::<f64>().sqrt();
    assert!((speed - GAIN * std::f64::consts::PI).abs() < 1e-9);
}

proptest! {
    #[test]
    fn feedback_can_always_brake(gain in 0.5..100.0_f64, deceleration in 0.1..50.0_f64, error in 1e-6..10.0_f64) {
        let feedback = Feedback { gain, deceleration };
        let speed = feedback.speed(error);
        prop_assert!(speed > 0.0 && speed <= gain * error * (1.0 + 1e-12));
        prop_assert!(speed * speed / (2.0 * deceleration) <= error);
        prop_assert_eq!(feedback.speed(-error), -speed);
        // The deceleration of a motion at this speed.
        let step = 1e-6 * error;
        let slope = (feedback.speed(error + step) - feedback.speed(error - step)) / (2.0 * step);
        prop_assert!(slope * speed <= deceleration * (1.0 + 1e-6));
    }
}
