//! Random chains, written as URDF, with the naive forward kinematics beside.

use std::fmt::Write as _;

use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, UnitVector3, Vector3};
use proptest::prelude::*;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Kind {
    Fixed,
    Prismatic,
    Revolute,
    Continuous,
}

/// A joint and the link it carries, and a fixed link beside it.
#[derive(Debug, Clone)]
pub(crate) struct Piece {
    pub(crate) kind: Kind,
    xyz: [f64; 3],
    rpy: [f64; 3],
    axis: [f64; 3],
    mass: f64,
    center: [f64; 3],
    branch_mass: f64,
}

pub(crate) fn pieces() -> impl Strategy<Value = Vec<Piece>> {
    let has_joint = |pieces: &Vec<Piece>| pieces.iter().any(|piece| piece.kind != Kind::Fixed);
    prop::collection::vec(piece(), 1..9).prop_filter("a joint", has_joint)
}

fn piece() -> impl Strategy<Value = Piece> {
    let kind = prop_oneof![
        Just(Kind::Fixed),
        Just(Kind::Prismatic),
        Just(Kind::Revolute),
        Just(Kind::Continuous)
    ];
    let vector = |size: f64| prop::array::uniform3(-size..size);
    let axis = prop_oneof![
        Just([0.0, 0.0, 1.0]),
        Just([0.0, 0.0, -1.0]),
        Just([0.0, 1.0, 0.0]),
        Just([-2.0, 0.0, 0.0]),
        vector(1.0).prop_filter("a direction", |axis| Vector3::from(*axis).norm() > 0.1),
    ];
    (kind, vector(0.5), vector(3.0), axis, 0.0..5.0, vector(0.2), 0.0..2.0).prop_map(
        |(kind, xyz, rpy, axis, mass, center, branch_mass)| Piece {
            kind,
            xyz,
            rpy,
            axis,
            mass,
            center,
            branch_mass,
        },
    )
}

pub(crate) fn urdf(pieces: &[Piece]) -> String {
    let mut text = String::from("<robot name=\"random\">\n<link name=\"link0\"/>\n");
    for (index, piece) in pieces.iter().enumerate() {
        let [x, y, z] = piece.xyz;
        let [roll, pitch, yaw] = piece.rpy;
        let [ax, ay, az] = piece.axis;
        let [cx, cy, cz] = piece.center;
        let kind = format!("{:?}", piece.kind).to_lowercase();
        let (mass, branch_mass, next) = (piece.mass, piece.branch_mass, index + 1);
        let inertia = "<inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/>";
        write!(
            text,
            r#"<joint name="joint{next}" type="{kind}">
  <origin xyz="{x} {y} {z}" rpy="{roll} {pitch} {yaw}"/>
  <parent link="link{index}"/><child link="link{next}"/>
  <axis xyz="{ax} {ay} {az}"/>
  <limit lower="-3" upper="3" velocity="2" effort="10"/>
</joint>
<link name="link{next}">
  <inertial><origin xyz="{cx} {cy} {cz}"/><mass value="{mass}"/>{inertia}</inertial>
</link>
<joint name="branch_joint{next}" type="fixed">
  <origin xyz="{z} {x} {y}" rpy="{yaw} {roll} {pitch}"/>
  <parent link="link{next}"/><child link="branch{next}"/>
</joint>
<link name="branch{next}">
  <inertial><origin xyz="{cz} {cx} {cy}"/><mass value="{branch_mass}"/>{inertia}</inertial>
</link>
"#
        )
        .unwrap();
    }
    text + "</robot>\n"
}

/// Pose of the last link, and Σ m c \[kg m\] of the links that move, one
/// matrix product after another.
pub(crate) fn naive(pieces: &[Piece], q: &[f64]) -> (Isometry3<f64>, Vector3<f64>) {
    let mut world = Isometry3::identity();
    let mut moment = Vector3::zeros();
    let mut positions = q.iter();
    let mut moves = false;
    for piece in pieces {
        world *= pose(piece.xyz, piece.rpy);
        let axis = UnitVector3::new_normalize(Vector3::from(piece.axis));
        match piece.kind {
            Kind::Fixed => {}
            Kind::Prismatic => world *= Translation3::from(*axis * *positions.next().unwrap()),
            Kind::Revolute | Kind::Continuous => {
                world *= UnitQuaternion::from_axis_angle(&axis, *positions.next().unwrap());
            }
        }
        moves |= piece.kind != Kind::Fixed;
        if moves {
            let [x, y, z] = piece.xyz;
            let [roll, pitch, yaw] = piece.rpy;
            let [cx, cy, cz] = piece.center;
            let branch = world * pose([z, x, y], [yaw, roll, pitch]);
            moment += piece.mass * (world * Point3::from(piece.center)).coords;
            moment += piece.branch_mass * (branch * Point3::new(cz, cx, cy)).coords;
        }
    }
    (world, moment)
}

fn pose([x, y, z]: [f64; 3], [roll, pitch, yaw]: [f64; 3]) -> Isometry3<f64> {
    let yawed = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
    let pitched = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), pitch);
    let rolled = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), roll);
    Isometry3::from_parts(Translation3::new(x, y, z), yawed * pitched * rolled)
}
