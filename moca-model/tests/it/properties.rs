//! What must hold for every chain and every configuration.

use crate::shared::MOCA;
use crate::support::{Kind, Piece, naive, pieces, urdf};
use approx::assert_abs_diff_eq;
use moca_model::{
    JointLimits, RobotData, RobotDescription, RobotModel, forward_kinematics, gravity, jacobian,
    potential_energy, world_from_link,
};
use nalgebra::{Isometry3, UnitQuaternion, Vector3, Vector6};
use proptest::prelude::*;

const STEP: f64 = 1e-6;

fn update(model: &RobotModel, data: &mut RobotData, q: &[f64]) {
    forward_kinematics(model, data, q).unwrap();
    jacobian(model, data).unwrap();
    gravity(model, data).unwrap();
}

/// Central difference of `value` by each element of q.
fn differences<T>(q: &[f64], mut value: impl FnMut(&[f64]) -> T) -> Vec<(T, T)> {
    (0..q.len())
        .map(|index| {
            let mut shifted = q.to_vec();
            shifted[index] = q[index] + STEP;
            let after = value(&shifted);
            shifted[index] = q[index] - STEP;
            (value(&shifted), after)
        })
        .collect()
}

/// Twist that takes one pose to another in 2 · STEP.
fn twist(before: &Isometry3<f64>, after: &Isometry3<f64>) -> Vector6<f64> {
    let linear = after.translation.vector - before.translation.vector;
    let angular = (after.rotation * before.rotation.inverse()).scaled_axis();
    let mut twist = Vector6::zeros();
    twist.fixed_rows_mut::<3>(0).copy_from(&linear);
    twist.fixed_rows_mut::<3>(3).copy_from(&angular);
    twist / (2.0 * STEP)
}

fn check_derivatives(model: &RobotModel, q: &[f64]) {
    let mut data = RobotData::new(model);
    update(model, &mut data, q);
    let mut other = RobotData::new(model);
    let poses = differences(q, |q| {
        forward_kinematics(model, &mut other, q).unwrap();
        *other.world_from_tool()
    });
    for (column, (before, after)) in data.jacobian().column_iter().zip(&poses) {
        assert_abs_diff_eq!(
            column.into_owned().fixed_rows::<6>(0).into_owned(),
            twist(before, after),
            epsilon = 1e-7
        );
    }
    let energies = differences(q, |q| {
        forward_kinematics(model, &mut other, q).unwrap();
        potential_energy(model, &other).unwrap()
    });
    for (torque, (before, after)) in data.gravity().iter().zip(&energies) {
        assert_abs_diff_eq!(*torque, (after - before) / (2.0 * STEP), epsilon = 1e-6);
    }
}

fn random_chain() -> impl Strategy<Value = (Vec<Piece>, Vec<f64>)> {
    pieces().prop_flat_map(|pieces| {
        let n = pieces.iter().filter(|piece| piece.kind != Kind::Fixed).count();
        (Just(pieces), prop::collection::vec(-3.0..3.0, n))
    })
}

fn chain_model(pieces: &[Piece], gravity: Vector3<f64>) -> RobotModel {
    let tool = format!("link{}", pieces.len());
    let description = RobotDescription { gravity, ..RobotDescription::new(tool) };
    RobotModel::from_urdf(&urdf(pieces), &description).unwrap()
}

fn moca_configuration() -> impl Strategy<Value = Vec<f64>> {
    let base = prop::collection::vec(-5.0..5.0, 3);
    let limits = MOCA.limits()[3..].to_vec();
    let arm: Vec<_> = limits.iter().map(|joint| joint.lower..joint.upper).collect();
    (base, arm).prop_map(|(base, arm)| [base, arm].concat())
}

proptest! {
    #[test]
    fn any_chain_stands_where_the_product_of_its_poses_puts_it((pieces, q) in random_chain()) {
        let free_fall = Vector3::new(1.0, -2.0, -9.0);
        let model = chain_model(&pieces, free_fall);
        prop_assert_eq!(model.joint_count(), q.len());
        let mut data = RobotData::new(&model);
        update(&model, &mut data, &q);
        let (tool, moment) = naive(&pieces, &q);
        assert_abs_diff_eq!(*data.world_from_tool(), tool, epsilon = 1e-11);
        let link = model.link(&format!("link{}", pieces.len())).unwrap();
        assert_abs_diff_eq!(world_from_link(&model, &data, link).unwrap(), tool, epsilon = 1e-11);
        let energy = potential_energy(&model, &data).unwrap();
        assert_abs_diff_eq!(energy, -free_fall.dot(&moment), epsilon = 1e-9);
    }

    #[test]
    fn jacobian_and_gravity_of_any_chain_are_derivatives((pieces, q) in random_chain()) {
        check_derivatives(&chain_model(&pieces, Vector3::new(1.0, -2.0, -9.0)), &q);
    }

    #[test]
    fn jacobian_and_gravity_of_moca_are_derivatives(q in moca_configuration()) {
        check_derivatives(&MOCA, &q);
    }

    #[test]
    fn driving_the_base_carries_the_tool_along(
        q in moca_configuration(), x in -3.0..3.0, y in -3.0..3.0, yaw in -7.0..7.0,
    ) {
        let model = &*MOCA;
        let mut still = RobotData::new(model);
        update(model, &mut still, &[&[0.0; 3], &q[3..]].concat());
        let mut driven = RobotData::new(model);
        update(model, &mut driven, &[&[x, y, yaw], &q[3..]].concat());

        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
        let drive = Isometry3::from_parts(Vector3::new(x, y, 0.0).into(), turn);
        assert_abs_diff_eq!(*driven.world_from_tool(), drive * still.world_from_tool(), epsilon = 1e-12);
        assert_abs_diff_eq!(driven.gravity(), still.gravity(), epsilon = 1e-11);
        // The arm's columns turn with the base; base x and y stay the world's.
        for (moved, original) in driven.jacobian().column_iter().zip(still.jacobian().column_iter()).skip(2) {
            for row in [0, 3] {
                let original = original.fixed_rows::<3>(row).into_owned();
                assert_abs_diff_eq!(moved.fixed_rows::<3>(row).into_owned(), turn * original, epsilon = 1e-12);
            }
        }
        for base in 0..2 {
            let mut axis = Vector6::zeros();
            axis[base] = 1.0;
            let column = driven.jacobian().fixed_view::<6, 1>(0, base).into_owned();
            assert_abs_diff_eq!(column, axis, epsilon = 1e-14);
        }
    }

    #[test]
    fn gravity_asks_nothing_of_the_base_on_a_level_floor(q in moca_configuration()) {
        let model = &*MOCA;
        let mut data = RobotData::new(model);
        update(model, &mut data, &q);
        for torque in data.gravity().iter().take(4) {
            prop_assert!(torque.abs() < 1e-12); // base x, y, yaw and the arm's upright first joint
        }
    }

    #[test]
    fn a_joint_does_not_move_what_comes_before_it(q in moca_configuration(), index in 0_usize..10, by in -1.0..1.0) {
        let model = &*MOCA;
        let mut data = RobotData::new(model);
        update(model, &mut data, &q);
        let mut moved_q = q.clone();
        moved_q[index] += by;
        let mut moved = RobotData::new(model);
        update(model, &mut moved, &moved_q);
        for joint in &model.joints()[..index] {
            prop_assert_eq!(
                world_from_link(model, &data, joint.child).unwrap(),
                world_from_link(model, &moved, joint.child).unwrap()
            );
        }
    }
}

#[test]
fn a_held_joint_carries_its_mass_to_where_it_is_held() {
    let mut description = RobotDescription::moca();
    let energy_with_finger_at = |description: &RobotDescription| {
        let model = RobotModel::from_urdf(moca_model::MOCA_URDF, description).unwrap();
        let mut data = RobotData::new(&model);
        // Hand level, so that the fingers' y axis can be upright.
        let q = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.5, 0.0, 0.0, 0.3];
        update(&model, &mut data, &q);
        let finger = model.link("panda_leftfinger").unwrap();
        let height = world_from_link(&model, &data, finger).unwrap().translation.vector.z;
        (potential_energy(&model, &data).unwrap(), height)
    };
    let closed = energy_with_finger_at(&description);
    description.held = vec![("panda_finger_joint1".into(), 0.04)];
    let open = energy_with_finger_at(&description);
    let lift = open.1 - closed.1;
    assert!(lift.abs() > 1e-3, "the finger must change height for this test to say something");
    assert_abs_diff_eq!(open.0 - closed.0, 0.015 * 9.81 * lift, epsilon = 1e-12);
}

#[test]
fn a_replaced_origin_moves_what_it_carries() {
    let mount = Isometry3::translation(0.1, -0.2, 0.5);
    let description = RobotDescription::moca().with_arm_mount(mount);
    let model = RobotModel::from_urdf(moca_model::MOCA_URDF, &description).unwrap();
    let data = RobotData::new(&model);
    let arm = model.link("panda_link0").unwrap();
    let pose = world_from_link(&model, &data, arm).unwrap();
    assert_abs_diff_eq!(pose.translation.vector, Vector3::new(0.1, -0.2, 0.62688), epsilon = 1e-12);
}

#[test]
fn holding_a_joint_of_the_way_takes_it_out_of_q() {
    let joints: Vec<_> =
        RobotDescription::moca().joints.into_iter().filter(|name| name != "panda_joint3").collect();
    let description = RobotDescription {
        joints,
        held: vec![("panda_joint3".into(), 0.7)],
        ..RobotDescription::moca()
    };
    let held = RobotModel::from_urdf(moca_model::MOCA_URDF, &description).unwrap();
    let free = &*MOCA;
    let (mut held_data, mut free_data) = (RobotData::new(&held), RobotData::new(free));
    let mut q = vec![0.3, 0.1, -0.4, 0.5, -0.6, 0.7, -1.8, 0.2, 1.5, -0.3];
    update(free, &mut free_data, &q);
    q.remove(5);
    update(&held, &mut held_data, &q);
    assert_eq!(held.joint_count(), 9);
    assert_abs_diff_eq!(
        *held_data.world_from_tool(),
        *free_data.world_from_tool(),
        epsilon = 1e-12
    );
    let expected = free_data.gravity().clone().remove_row(5);
    assert_abs_diff_eq!(*held_data.gravity(), expected, epsilon = 1e-11);
    assert_abs_diff_eq!(
        *held_data.jacobian(),
        free_data.jacobian().clone().remove_column(5),
        epsilon = 1e-12
    );
}

#[test]
fn limits_of_moca_are_the_makers() {
    let model = &*MOCA;
    let limits = model.limits();
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

#[test]
fn acceleration_and_jerk_of_a_urdf_1_2_count() {
    let text = moca_model::MOCA_URDF
        .replace("<robot name=\"moca\">", "<robot name=\"moca\" version=\"1.2\">")
        .replace("velocity=\"2.61\"", "velocity=\"2.61\" acceleration=\"9\" jerk=\"900\"");
    let model = RobotModel::from_urdf(&text, &RobotDescription::new("panda_tcp")).unwrap();
    let known = model.limits()[9];
    assert_eq!((known.acceleration, known.jerk), (9.0, 900.0));
    let unknown = model.limits()[3];
    assert_eq!((unknown.acceleration, unknown.jerk), (f64::INFINITY, f64::INFINITY));
}
