//! Properties of MOCA in every configuration.

use approx::assert_abs_diff_eq;
use moca_model::whole_body::robot::JointLimits;
use moca_model::whole_body::{Data, Model};
use moca_model::{
    Kinematics, MOCA_ARM_MOUNT, MOCA_HOME, MOCA_TOOL, MOCA_URDF, moca_description, moca_safety,
};
use nalgebra::{Isometry3, UnitQuaternion, Vector3, Vector6};
use proptest::prelude::*;

use crate::shared::MOCA;

const STEP: f64 = 1e-6;

/// MOCA with its bodies at q.
fn moca_at(q: &[f64]) -> Kinematics {
    Kinematics::new(MOCA.clone(), MOCA_TOOL, &moca_safety().bodies, q).unwrap()
}

fn gravity(q: &[f64]) -> [f64; 10] {
    let mut torques = [0.0; 10];
    Data::new(&MOCA).pose(&MOCA, q).unwrap().gravity_into(&mut torques).unwrap();
    torques
}

fn moca_configuration() -> impl Strategy<Value = Vec<f64>> {
    let base = prop::collection::vec(-5.0..5.0, 3);
    let limits = MOCA.limits()[3..].to_vec();
    let arm: Vec<_> = limits.iter().map(|joint| joint.lower..joint.upper).collect();
    (base, arm).prop_map(|(base, arm)| [base, arm].concat())
}

/// q with one joint a step before and a step behind.
fn around(q: &[f64], joint: usize) -> [Vec<f64>; 2] {
    [-STEP, STEP].map(|step| {
        let mut moved = q.to_vec();
        moved[joint] += step;
        moved
    })
}

proptest! {
    #[test]
    fn jacobian_is_derivative_of_tool_pose(q in moca_configuration()) {
        let robot = moca_at(&q);
        for (joint, column) in robot.jacobian().column_iter().enumerate() {
            let [before, after] = around(&q, joint).map(|q| *moca_at(&q).world_from_tool());
            let linear = after.translation.vector - before.translation.vector;
            let angular = (after.rotation * before.rotation.inverse()).scaled_axis();
            let twist = Vector6::from_iterator(linear.iter().chain(&angular).map(|d| d / (2.0 * STEP)));
            assert_abs_diff_eq!(column.into_owned(), twist, epsilon = 1e-7);
        }
    }

    #[test]
    fn bodies_move_by_first_jacobian_columns(q in moca_configuration()) {
        let robot = moca_at(&q);
        let tool = robot.world_from_tool().translation.vector;
        for joint in 0..10 {
            let [before, after] = around(&q, joint).map(|q| moca_at(&q));
            let column = robot.jacobian().column(joint);
            let (linear, angular) = (column.fixed_rows::<3>(0), column.fixed_rows::<3>(3));
            for (index, body) in robot.bodies().iter().enumerate() {
                let end = |robot: &Kinematics| *robot.bodies()[index].capsule.end();
                let expected = if joint < body.joints {
                    linear + angular.cross(&(body.capsule.end() - tool))
                } else {
                    Vector3::zeros()
                };
                let velocity = (end(&after) - end(&before)) / (2.0 * STEP);
                assert_abs_diff_eq!(velocity, expected, epsilon = 1e-7);
            }
        }
    }

    #[test]
    fn driving_the_base_carries_the_tool_along(
        q in moca_configuration(), x in -3.0..3.0, y in -3.0..3.0, yaw in -7.0..7.0,
    ) {
        let (still_q, driven_q) =
            ([&[0.0; 3], &q[3..]].concat(), [&[x, y, yaw], &q[3..]].concat());
        let (still, driven) = (moca_at(&still_q), moca_at(&driven_q));
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
        let drive = Isometry3::from_parts(Vector3::new(x, y, 0.0).into(), turn);
        assert_abs_diff_eq!(*driven.world_from_tool(), drive * still.world_from_tool(), epsilon = 1e-12);
        assert_abs_diff_eq!(gravity(&driven_q)[..], gravity(&still_q)[..], epsilon = 1e-11);
        // The arm's columns rotate with the base; those of base x and y stay the world's.
        for (moved, original) in driven.jacobian().column_iter().zip(still.jacobian().column_iter()).skip(2) {
            for row in [0, 3] {
                let original = original.fixed_rows::<3>(row).into_owned();
                assert_abs_diff_eq!(moved.fixed_rows::<3>(row).into_owned(), turn * original, epsilon = 1e-12);
            }
        }
        for base in 0..2 {
            let mut axis = Vector6::zeros();
            axis[base] = 1.0;
            assert_abs_diff_eq!(driven.jacobian().column(base).into_owned(), axis, epsilon = 1e-14);
        }
    }

    #[test]
    fn gravity_needs_no_base_force_on_floor(q in moca_configuration()) {
        for torque in &gravity(&q)[..4] {
            prop_assert!(torque.abs() < 1e-12); // base x, y, yaw and the arm's upright first joint
        }
    }
}

#[test]
fn an_arm_mounted_elsewhere_stands_there() {
    let mut description = moca_description();
    let mount = Isometry3::translation(0.1, -0.2, 0.5);
    description.origins.push((MOCA_ARM_MOUNT.to_owned(), mount));
    let model = Model::from_urdf(MOCA_URDF, &description).unwrap();
    let arm = model.frame_id("panda_link0").unwrap();
    let pose = Data::new(&model).pose(&model, &[0.0; 10]).unwrap().world_from(arm).unwrap();
    assert_abs_diff_eq!(pose.translation.vector, Vector3::new(0.1, -0.2, 0.62688), epsilon = 1e-12);
}

#[test]
fn moca_is_read_without_a_warning() {
    assert!(MOCA.warnings().is_empty(), "{:?}", MOCA.warnings());
    assert!(MOCA.default_accelerations().is_empty());
    assert!(MOCA.is_configuration(&MOCA_HOME));
}

#[test]
fn limits_of_moca_are_the_makers() {
    let limits = MOCA.limits();
    assert_eq!(limits.len(), 10);
    for (base, (velocity, acceleration)) in limits.iter().zip([(1.5, 0.6), (1.5, 0.6), (3.0, 1.5)])
    {
        assert_eq!((base.lower, base.upper), (f64::NEG_INFINITY, f64::INFINITY));
        assert_eq!((base.velocity, base.acceleration), (velocity, acceleration));
        assert_eq!((base.jerk, base.effort), (f64::INFINITY, f64::INFINITY));
    }
    let velocity = [2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61];
    let acceleration = [15.0, 7.5, 10.0, 12.5, 15.0, 20.0, 20.0];
    let effort = [87.0, 87.0, 87.0, 87.0, 12.0, 12.0, 12.0];
    for (index, arm) in limits[3..].iter().enumerate() {
        let expected = JointLimits {
            velocity: velocity[index],
            acceleration: acceleration[index],
            jerk: acceleration[index] * 500.0,
            effort: effort[index],
            ..*arm
        };
        assert_eq!(*arm, expected);
    }
    assert_eq!((limits[6].lower, limits[6].upper), (-3.0718, -0.0698));
    assert_eq!((limits[8].lower, limits[8].upper), (-0.0175, 3.7525));
}
