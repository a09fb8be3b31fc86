//! Random trees, written as URDF, with states.

pub(crate) mod arms;
pub(crate) mod monitor;
pub(crate) mod stacks;

use std::fmt::Write as _;
use std::ops::Range;

use nalgebra::{Isometry3, Matrix3, Matrix6xX, UnitQuaternion, Vector3, Vector6};
use proptest::prelude::*;
use whole_body::{Axes, Base, Data, Description, FrameId, Model};

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Kind {
    Fixed,
    Prismatic,
    Revolute,
    Continuous,
    /// Follows the nearest independent joint before it in the text, if there is one.
    Mimic,
}

/// A joint and the link that it carries. Its parent is one of the links before it.
#[derive(Debug, Clone)]
pub(crate) struct Piece {
    pub(crate) kind: Kind,
    pub(crate) parent: usize,
    pub(crate) xyz: [f64; 3],
    pub(crate) rpy: [f64; 3],
    pub(crate) axis: [f64; 3],
    pub(crate) mass: f64,
    pub(crate) centre: [f64; 3],
    /// Edges of a solid box \[m\].
    edges: [f64; 3],
    tilt: [f64; 3],
}

/// A robot as text, with the base to read it with.
#[derive(Debug, Clone)]
pub(crate) struct Robot {
    pub(crate) pieces: Vec<Piece>,
    pub(crate) base: Base,
    pub(crate) root: Piece,
}

/// q, q̇ and q̈ of a robot.
#[derive(Debug, Clone)]
pub(crate) struct State {
    pub(crate) q: Vec<f64>,
    pub(crate) v: Vec<f64>,
    pub(crate) a: Vec<f64>,
}

/// Trees of up to ten joints on all bases.
pub(crate) fn robots() -> impl Strategy<Value = Robot> {
    robots_of(&[Kind::Fixed, Kind::Prismatic, Kind::Revolute, Kind::Continuous, Kind::Mimic])
}

/// Trees of up to ten joints of these kinds on all bases.
pub(crate) fn robots_of(kinds: &'static [Kind]) -> impl Strategy<Value = Robot> {
    let base = prop_oneof![Just(Base::Fixed), Just(Base::Planar), Just(Base::Floating)];
    let kinds = prop::sample::select(kinds);
    let pieces = prop::collection::vec(piece(kinds.boxed()), 1..11);
    (pieces, piece(Just(Kind::Fixed).boxed()), base)
        .prop_map(|(mut pieces, root, base)| {
            for (index, piece) in pieces.iter_mut().enumerate() {
                // Long paths and branches are both likely.
                piece.parent = index.saturating_sub(piece.parent);
            }
            Robot { pieces, base, root }
        })
        .prop_filter("a joint", |robot| {
            robot.pieces.iter().any(|piece| piece.kind != Kind::Fixed && piece.kind != Kind::Mimic)
        })
}

fn vector(size: f64) -> impl Strategy<Value = [f64; 3]> {
    prop::array::uniform3(-size..size)
}

fn piece(kind: BoxedStrategy<Kind>) -> impl Strategy<Value = Piece> {
    let axis = prop_oneof![
        Just([0.0, 0.0, 1.0]),
        Just([0.0, 0.0, -1.0]),
        Just([0.0, 1.0, 0.0]),
        Just([-2.0, 0.0, 0.0]),
        vector(1.0).prop_filter("a direction", |axis| Vector3::from(*axis).norm() > 0.1),
    ];
    let edges = prop::array::uniform3(0.05..0.5);
    let back = prop_oneof![3 => Just(0_usize), 1 => 1..4_usize];
    (kind, back, vector(0.5), vector(3.0), axis, 0.1..5.0, vector(0.2), edges, vector(3.0))
        .prop_map(|(kind, parent, xyz, rpy, axis, mass, centre, edges, tilt)| Piece {
            kind,
            parent,
            xyz,
            rpy,
            axis,
            mass,
            centre,
            edges,
            tilt,
        })
}

pub(crate) fn states(robot: Robot) -> impl Strategy<Value = (Robot, State)> {
    let joints =
        robot.pieces.iter().filter(|piece| !matches!(piece.kind, Kind::Fixed | Kind::Mimic));
    let (base, n) = (robot.base, joints.count());
    let size = n + match base {
        Base::Fixed => 0,
        Base::Planar => 3,
        Base::Floating => 6,
    };
    let list = |range: Range<f64>, count: usize| prop::collection::vec(range, count);
    let (place, turn) = (vector(3.0), vector(2.0));
    (Just(robot), place, turn, list(-2.0..2.0, n), list(-2.0..2.0, size), list(-3.0..3.0, size))
        .prop_map(move |(robot, place, turn, joints, v, a)| {
            let rotation = UnitQuaternion::from_scaled_axis(Vector3::from(turn));
            let base = match base {
                Base::Fixed => vec![],
                Base::Planar => vec![place[0], place[1], 4.0 * turn[2]],
                Base::Floating => place.iter().chain(&rotation.coords).copied().collect(),
            };
            (robot, State { q: [base, joints].concat(), v, a })
        })
}

pub(crate) fn robots_with_states() -> impl Strategy<Value = (Robot, State)> {
    robots().prop_flat_map(states)
}

impl Robot {
    pub(crate) fn on(self, base: Base) -> Self {
        Self { base, ..self }
    }

    pub(crate) fn model(&self) -> Model {
        Model::from_urdf(&self.urdf(), &self.description()).unwrap()
    }

    pub(crate) fn description(&self) -> Description {
        Description {
            base: self.base,
            gravity: Vector3::new(1.0, -2.0, -9.0),
            ..Description::default()
        }
    }

    pub(crate) fn urdf(&self) -> String {
        let mut text = String::from("<robot name=\"random\">\n");
        writeln!(text, "<link name=\"link0\">{}</link>", inertial(&self.root)).unwrap();
        for (index, piece) in self.pieces.iter().enumerate() {
            let next = index + 1;
            writeln!(text, "<link name=\"link{next}\">{}</link>", inertial(piece)).unwrap();
            let [x, y, z] = piece.xyz;
            let [roll, pitch, yaw] = piece.rpy;
            let [ax, ay, az] = piece.axis;
            let leader = self.pieces[..index]
                .iter()
                .rposition(|piece| !matches!(piece.kind, Kind::Fixed | Kind::Mimic));
            let (kind, mimic) = match (piece.kind, leader) {
                (Kind::Mimic, Some(leader)) => (
                    "revolute".to_owned(),
                    format!(
                        "<mimic joint=\"joint{}\" multiplier=\"{}\" offset=\"{}\"/>",
                        leader + 1,
                        1.5 * ay + 0.1,
                        ax
                    ),
                ),
                (Kind::Mimic, None) => ("fixed".to_owned(), String::new()),
                (kind, _) => (format!("{kind:?}").to_lowercase(), String::new()),
            };
            write!(
                text,
                "<joint name=\"joint{next}\" type=\"{kind}\">
  <origin xyz=\"{x} {y} {z}\" rpy=\"{roll} {pitch} {yaw}\"/>
  <parent link=\"link{}\"/><child link=\"link{next}\"/>
  <axis xyz=\"{ax} {ay} {az}\"/>{mimic}
  <limit lower=\"-3\" upper=\"3\" velocity=\"2\" effort=\"10\"/>
</joint>\n",
                piece.parent
            )
            .unwrap();
        }
        text + "</robot>\n"
    }
}

/// A tilted box of uniform density.
fn inertial(piece: &Piece) -> String {
    let [a, b, c] = piece.edges.map(|edge| edge * edge * piece.mass / 12.0);
    let moments = Matrix3::from_diagonal(&Vector3::new(b + c, a + c, a + b));
    let tilt = UnitQuaternion::from_scaled_axis(Vector3::from(piece.tilt)).to_rotation_matrix();
    let i = tilt.matrix() * moments * tilt.matrix().transpose();
    let [x, y, z] = piece.centre;
    format!(
        "<inertial><origin xyz=\"{x} {y} {z}\"/><mass value=\"{}\"/><inertia ixx=\"{}\" iyy=\"{}\" \
         izz=\"{}\" ixy=\"{}\" ixz=\"{}\" iyz=\"{}\"/></inertial>",
        piece.mass,
        i[(0, 0)],
        i[(1, 1)],
        i[(2, 2)],
        i[(0, 1)],
        i[(0, 2)],
        i[(1, 2)]
    )
}

/// The result of `integrate` from q along `v` for `time` seconds.
pub(crate) fn after(model: &Model, q: &[f64], v: &[f64], time: f64) -> Vec<f64> {
    let mut moved = q.to_vec();
    let displacement: Vec<_> = v.iter().map(|v| v * time).collect();
    model.integrate(&mut moved, &displacement).unwrap();
    moved
}

/// The last frame of the model.
pub(crate) fn last_frame(model: &Model) -> FrameId {
    model.frames().last().unwrap().0
}

pub(crate) fn pose(model: &Model, q: &[f64], frame: FrameId) -> Isometry3<f64> {
    Data::new(model).pose(model, q).unwrap().world_from(frame).unwrap()
}

pub(crate) fn jacobian(model: &Model, q: &[f64], frame: FrameId, axes: Axes) -> Matrix6xX<f64> {
    let mut out = Matrix6xX::zeros(model.velocity_count());
    Data::new(model).pose(model, q).unwrap().jacobian_into(frame, axes, &mut out).unwrap();
    out
}

/// The twist, linear, then angular in the world's axes, that takes one pose to another in `time`.
pub(crate) fn twist_between(
    before: &Isometry3<f64>,
    after: &Isometry3<f64>,
    time: f64,
) -> Vector6<f64> {
    let linear = after.translation.vector - before.translation.vector;
    let angular = (after.rotation * before.rotation.inverse()).scaled_axis();
    let mut twist = Vector6::zeros();
    twist.fixed_rows_mut::<3>(0).copy_from(&linear);
    twist.fixed_rows_mut::<3>(3).copy_from(&angular);
    twist / time
}
