//! Poses, Jacobians and their rates, for every tree, base and configuration.

use approx::assert_abs_diff_eq;
use nalgebra::{DVector, Matrix6xX, Vector6};
use proptest::prelude::*;
use whole_body::{Axes, Data};

use crate::support::{after, jacobian, last_frame, pose, robots_with_states, twist_between};

const STEP: f64 = 1e-6;

proptest! {
    #[test]
    fn jacobians_of_all_frames_are_derivatives((robot, state) in robots_with_states()) {
        let model = robot.model();
        for (frame, _) in model.frames() {
            let jacobian = jacobian(&model, &state.q, frame, Axes::World);
            for column in 0..model.velocity_count() {
                let mut v = vec![0.0; model.velocity_count()];
                v[column] = 1.0;
                let [before, after] =
                    [-STEP, STEP].map(|time| pose(&model, &after(&model, &state.q, &v, time), frame));
                let twist = twist_between(&before, &after, 2.0 * STEP);
                assert_abs_diff_eq!(jacobian.column(column).into_owned(), twist, epsilon = 1e-7);
            }
        }
    }

    #[test]
    fn local_axes_are_those_of_the_frame((robot, state) in robots_with_states()) {
        let model = robot.model();
        let frame = last_frame(&model);
        let turn = pose(&model, &state.q, frame).rotation.inverse();
        let world = jacobian(&model, &state.q, frame, Axes::World);
        let local = jacobian(&model, &state.q, frame, Axes::Local);
        for (world, local) in world.column_iter().zip(local.column_iter()) {
            for row in [0, 3] {
                let expected = turn * world.fixed_rows::<3>(row).into_owned();
                assert_abs_diff_eq!(local.fixed_rows::<3>(row).into_owned(), expected, epsilon = 1e-12);
            }
        }
    }

    #[test]
    fn twists_are_the_jacobians_times_velocity((robot, state) in robots_with_states()) {
        let model = robot.model();
        let v = DVector::from_column_slice(&state.v);
        let mut data = Data::new(&model);
        for axes in [Axes::World, Axes::Local] {
            for (frame, _) in model.frames() {
                let expected: Vector6<f64> = jacobian(&model, &state.q, frame, axes) * &v;
                let moving = data.pose(&model, &state.q).unwrap().moving(&state.v).unwrap();
                assert_abs_diff_eq!(moving.twist(frame, axes).unwrap(), expected, epsilon = 1e-11);
            }
        }
    }

    #[test]
    fn the_jacobians_rate_is_a_derivative((robot, state) in robots_with_states()) {
        let model = robot.model();
        let v = DVector::from_column_slice(&state.v);
        let mut data = Data::new(&model);
        for axes in [Axes::World, Axes::Local] {
            for (frame, _) in model.frames() {
                let [before, later] = [-STEP, STEP].map(|time| {
                    jacobian(&model, &after(&model, &state.q, &state.v, time), frame, axes)
                });
                let expected: Vector6<f64> = (later - before) / (2.0 * STEP) * &v;
                let moving = data.pose(&model, &state.q).unwrap().moving(&state.v).unwrap();
                let rate = moving.jacobian_rate_times_velocity(frame, axes).unwrap();
                assert_abs_diff_eq!(rate, expected, epsilon = 2e-6);
            }
        }
    }

    #[test]
    fn relative_motion_is_a_derivative((robot, state) in robots_with_states()) {
        let model = robot.model();
        let frames: Vec<_> = model.frames().map(|(frame, _)| frame).collect();
        let (one, other) = (frames[frames.len() / 2], frames[frames.len() - 1]);
        let v = DVector::from_column_slice(&state.v);
        let relative = |time: f64| {
            let q = after(&model, &state.q, &state.v, time);
            let mut data = Data::new(&model);
            let posed = data.pose(&model, &q).unwrap();
            let mut jacobian = Matrix6xX::zeros(model.velocity_count());
            posed.relative_jacobian_into(one, other, &mut jacobian).unwrap();
            let twist: Vector6<f64> = jacobian * &v;
            (posed.relative_pose(one, other).unwrap(), twist)
        };
        let ((before, _), now, (later, _)) = (relative(-STEP), relative(0.0), relative(STEP));
        let mut data = Data::new(&model);
        let posed = data.pose(&model, &state.q).unwrap();
        assert_abs_diff_eq!(now.1, twist_between(&before, &later, 2.0 * STEP), epsilon = 1e-6);
        let expected =
            posed.world_from(one).unwrap().inverse() * posed.world_from(other).unwrap();
        assert_abs_diff_eq!(now.0, expected, epsilon = 1e-11);
    }

    #[test]
    fn integrate_and_difference_are_inverse((robot, state) in robots_with_states()) {
        let model = robot.model();
        let end = after(&model, &state.q, &state.v, 0.7);
        let mut moved = vec![0.0; model.velocity_count()];
        model.difference(&state.q, &end, &mut moved).unwrap();
        for (moved, v) in moved.iter().zip(&state.v) {
            assert_abs_diff_eq!(*moved, 0.7 * v, epsilon = 1e-9);
        }
    }
}

#[test]
fn model_is_shared_and_data_is_sent() {
    fn shared<T: Send + Sync>() {}
    fn sent<T: Send>() {}
    shared::<whole_body::Model>();
    sent::<Data>();
}
