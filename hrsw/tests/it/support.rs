//! Random shapes, poses and workspaces.

use hrsw::{
    Bounds, Capsule, Cone, HalfSpace, OrientationShape, OrientedBox, Polytope, PositionShape,
    Workspace,
};
use nalgebra::{Isometry3, UnitQuaternion, Vector3, Vector6};
use proptest::prelude::*;

pub(crate) fn vector(size: f64) -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(-1.0..1.0_f64).prop_map(move |v| Vector3::from(v) * size)
}

pub(crate) fn direction() -> impl Strategy<Value = Vector3<f64>> {
    vector(1.0).prop_filter_map("a direction", |v| v.try_normalize(0.1))
}

pub(crate) fn rotation() -> impl Strategy<Value = UnitQuaternion<f64>> {
    vector(1.8).prop_map(UnitQuaternion::from_scaled_axis)
}

pub(crate) fn pose(reach: f64, angle: f64) -> impl Strategy<Value = Isometry3<f64>> {
    (vector(reach), vector(angle)).prop_map(|(p, v)| Isometry3::new(p, v))
}

pub(crate) fn twist() -> impl Strategy<Value = Vector6<f64>> {
    prop::array::uniform6(-0.5..0.5_f64).prop_map(Vector6::from)
}

pub(crate) fn bounds() -> impl Strategy<Value = Bounds> {
    (vector(0.6), vector(0.6)).prop_map(|(a, b)| Bounds::new(a.inf(&b), a.sup(&b)).unwrap())
}

/// Generates hulls, and cubes with corners cut off.
pub(crate) fn polytope() -> impl Strategy<Value = Polytope> {
    let hull = prop::collection::vec(vector(0.6), 6..14)
        .prop_filter_map("a volume", |points| Polytope::hull(&points).ok());
    let cut = prop::collection::vec((direction(), 0.2..0.7_f64), 0..8).prop_map(|cuts| {
        let cube = (0..6).map(|i| {
            let sign = if i < 3 { 1.0 } else { -1.0 };
            HalfSpace::new(Vector3::ith(i % 3, sign), 0.5).unwrap()
        });
        let cuts = cuts.into_iter().map(|(normal, offset)| HalfSpace::new(normal, offset).unwrap());
        Polytope::new(&cube.chain(cuts).collect::<Vec<_>>()).unwrap()
    });
    prop_oneof![hull, cut]
}

pub(crate) fn capsule(reach: f64) -> impl Strategy<Value = Capsule> {
    prop_oneof![
        (vector(reach), vector(reach), 0.02..0.4_f64)
            .prop_map(|(a, b, radius)| Capsule::new(a, b, radius).unwrap()),
        (vector(reach), 0.02..0.4_f64)
            .prop_map(|(center, radius)| Capsule::sphere(center, radius).unwrap()),
    ]
}

pub(crate) fn position_shape() -> impl Strategy<Value = PositionShape> {
    prop_oneof![
        bounds().prop_map(PositionShape::from),
        (pose(0.3, 1.5), bounds())
            .prop_map(|(pose, bounds)| OrientedBox::new(pose, bounds).unwrap().into()),
        polytope().prop_map(PositionShape::from),
        capsule(0.5).prop_map(PositionShape::from),
    ]
}

pub(crate) fn orientation_shape() -> impl Strategy<Value = OrientationShape> {
    prop_oneof![
        vector(0.5).prop_map(|v| Bounds::symmetric(v.abs()).unwrap().into()),
        (direction(), direction(), 0.0..2.5_f64).prop_map(|(axis, to, angle)| Cone::new(
            axis, to, angle
        )
        .unwrap()
        .into()),
    ]
}

/// Generates moving workspaces of all shapes, whose references turn.
pub(crate) fn workspace() -> impl Strategy<Value = Workspace> {
    let shapes = (position_shape(), orientation_shape());
    (pose(3.0, 1.5), twist(), vector(0.5), vector(0.8), shapes).prop_map(
        |(frame, twist, reference, rate, (position, orientation))| {
            let mut workspace = Workspace::new(frame, position, orientation).unwrap();
            workspace.place(frame, twist).unwrap();
            let reference = UnitQuaternion::from_scaled_axis(reference);
            workspace.set_reference(reference, rate).unwrap();
            workspace
        },
    )
}

/// Returns the workspace `time` seconds later, with unchanged shapes.
pub(crate) fn moved(workspace: &Workspace, time: f64) -> Workspace {
    let twist = *workspace.twist();
    let mut moved = workspace.clone();
    let frame =
        ahqp_core::integrate_pose(workspace.world_from_workspace(), workspace.twist(), time);
    moved.place(frame, twist).unwrap();
    moved
}
