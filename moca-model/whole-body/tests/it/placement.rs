//! Poses of links, compared with plain products of poses.

use approx::assert_abs_diff_eq;
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, UnitVector3, Vector3};
use proptest::prelude::*;
use whole_body::{Base, Data};

use crate::support::{Kind, Piece, Robot, State, robots_of, states};

/// Kinds of joints that follow no other.
const KINDS: &[Kind] = &[Kind::Fixed, Kind::Prismatic, Kind::Revolute, Kind::Continuous];

/// Trees on all bases, with states.
fn trees() -> impl Strategy<Value = (Robot, State)> {
    robots_of(KINDS).prop_flat_map(states)
}

/// Pose of each link, and Σ m c \[kg m\] of the links that move.
fn naive(robot: &Robot, q: &[f64]) -> (Vec<Isometry3<f64>>, Vector3<f64>) {
    let (root, mut positions) = root_pose(robot.base, q);
    let mut poses = vec![root];
    let mut moves = vec![robot.base != Base::Fixed];
    let pieces = robot.pieces.iter();
    for piece in pieces {
        let mut pose = poses[piece.parent] * origin(piece);
        let axis = UnitVector3::new_normalize(Vector3::from(piece.axis));
        match piece.kind {
            Kind::Fixed | Kind::Mimic => {}
            Kind::Prismatic => pose *= Translation3::from(*axis * *positions.next().unwrap()),
            Kind::Revolute | Kind::Continuous => {
                pose *= UnitQuaternion::from_axis_angle(&axis, *positions.next().unwrap());
            }
        }
        poses.push(pose);
        moves.push(moves[piece.parent] || piece.kind != Kind::Fixed);
    }
    let links = std::iter::once(&robot.root).chain(&robot.pieces);
    let moving = links.zip(&poses).zip(moves).filter(|(_, moves)| *moves);
    let moment = moving
        .map(|((piece, pose), _)| piece.mass * (pose * Point3::from(piece.centre)).coords)
        .sum();
    (poses, moment)
}

/// The pose of the root link, and the joints' part of q in the order of the text.
fn root_pose(base: Base, q: &[f64]) -> (Isometry3<f64>, std::slice::Iter<'_, f64>) {
    match base {
        Base::Fixed => (Isometry3::identity(), q.iter()),
        Base::Planar => {
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), q[2]);
            (Isometry3::from_parts(Translation3::new(q[0], q[1], 0.0), turn), q[3..].iter())
        }
        Base::Floating => {
            let turn = nalgebra::Quaternion::new(q[6], q[3], q[4], q[5]);
            let turn = UnitQuaternion::from_quaternion(turn);
            (Isometry3::from_parts(Translation3::new(q[0], q[1], q[2]), turn), q[7..].iter())
        }
    }
}

fn origin(piece: &Piece) -> Isometry3<f64> {
    let ([x, y, z], [roll, pitch, yaw]) = (piece.xyz, piece.rpy);
    let turn = |axis, angle| UnitQuaternion::from_axis_angle(&axis, angle);
    let rotation = turn(Vector3::z_axis(), yaw)
        * turn(Vector3::y_axis(), pitch)
        * turn(Vector3::x_axis(), roll);
    Isometry3::from_parts(Translation3::new(x, y, z), rotation)
}

/// q with the joints in the order of the text, from that of the model.
fn in_order_of_the_text(robot: &Robot, q: &[f64]) -> Vec<f64> {
    let model = robot.model();
    let base = match robot.base {
        Base::Fixed => 0,
        Base::Planar => 3,
        Base::Floating => 7,
    };
    let joints = (1..=robot.pieces.len()).filter_map(|number| {
        let joint = model.joint_id(&format!("joint{number}")).ok()?;
        Some(q[model.joint(joint).unwrap().position_index])
    });
    q[..base].iter().copied().chain(joints).collect()
}

proptest! {
    #[test]
    fn link_poses_are_products_of_joint_poses((robot, state) in trees()) {
        let model = robot.model();
        let (poses, moment) = naive(&robot, &in_order_of_the_text(&robot, &state.q));
        let mut data = Data::new(&model);
        let posed = data.pose(&model, &state.q).unwrap();
        for (number, expected) in poses.iter().enumerate() {
            let link = model.frame_id(&format!("link{number}")).unwrap();
            assert_abs_diff_eq!(posed.world_from(link).unwrap(), *expected, epsilon = 1e-11);
        }
        let energy = -model.gravity().dot(&moment);
        assert_abs_diff_eq!(posed.potential_energy(), energy, epsilon = 1e-9);
    }

    #[test]
    fn joint_moves_its_subtree_and_nothing_else((robot, state) in trees(), by in 0.1..1.0) {
        let model = robot.model();
        let (mut data, mut other) = (Data::new(&model), Data::new(&model));
        let posed = data.pose(&model, &state.q).unwrap();
        for joint in model.joints().iter().filter(|joint| joint.kind.positions() == 1) {
            let mut q = state.q.clone();
            q[joint.position_index] += by;
            let moved = other.pose(&model, &q).unwrap();
            for (frame, name) in model.frames() {
                let same = posed.world_from(frame).unwrap() == moved.world_from(frame).unwrap();
                let hangs = model.moved_by(frame).unwrap().any(|entry| entry == joint.velocity_index);
                prop_assert_eq!(same, !hangs, "joint {} and link {}", &joint.name, name);
            }
        }
    }
}
