//! Comparison of softened workspaces with Clarabel, and the effect of slack and weights.

use crate::support::*;
use ahqp_core::{
    AugmentedState, Hierarchy, Level, Rows, Settings, Solver, integrate_pose, solve_reference,
};
use hrsw::{Bounds, Error, Polytope, SoftWorkspace, Softening, Workspace};
use nalgebra::{DMatrix, DVector, Isometry3, Vector3, Vector6};
use proptest::prelude::*;

const SLACK: AugmentedState = AugmentedState { joints: 1, task: 6, slack: 6 };
const HORIZON: f64 = 0.2;

fn softening() -> Softening {
    Softening { position_rows: 64, ..Softening::default() }
}

/// Creates a hierarchy of one level over χ with ẋ_d within ±`speed`.
fn hierarchy(soft: &SoftWorkspace, level: Level, speed: f64) -> Hierarchy {
    let mut hierarchy = Hierarchy::new(SLACK.len()).unwrap();
    let (lower, upper) = hierarchy.bounds_mut();
    for index in SLACK.desired_velocity() {
        lower[index] = -speed;
        upper[index] = speed;
    }
    assert_eq!(soft.capacity(), 70);
    hierarchy.push(level).unwrap();
    hierarchy
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// There is as little slack as Clarabel finds, and none if it finds none.
    #[test]
    fn the_slack_is_the_least_there_is(
        workspace in workspace(), relative in pose(0.6, 0.8), speed in 0.2..2.0_f64,
    ) {
        let desired = workspace.world_from_workspace() * relative;
        let soft = SoftWorkspace::new(SLACK, HORIZON, softening()).unwrap();
        let mut level = soft.level().unwrap();
        soft.write_rows(&workspace, &desired, level.constraints_mut()).unwrap();
        let hierarchy = hierarchy(&soft, level, speed);
        let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
        let ours = solver.solve(&hierarchy).unwrap().optimum().unwrap().to_vec();
        let reference = solve_reference(&hierarchy).unwrap();
        let cost = |x: &[f64]| x[7..].iter().map(|s| s * s).sum();
        let (ours, reference): (f64, f64) = (cost(&ours), cost(reference.as_slice()));
        prop_assert!(ours <= reference + 1e-7, "{ours} {reference}");
        if reference < 1e-12 {
            prop_assert!(ours.sqrt() <= 1e-9, "{ours} {reference}");
        }
    }

    /// From every start the pose comes inside all bounds by the margin, and not farther than
    /// needed, and stays there.
    #[test]
    fn a_margin_keeps_the_pose_that_far_within(
        frame in pose(1.0, 1.0), half in vector(0.2), turn in vector(0.15), relative in pose(0.6, 0.7),
        margin in 0.0..0.05_f64,
    ) {
        let wide = |half: Vector3<f64>| Bounds::symmetric(half.abs().add_scalar(0.06)).unwrap();
        let workspace = Workspace::new(frame, wide(half), wide(turn)).unwrap();
        let softening = Softening { margin, ..softening() };
        let soft = SoftWorkspace::new(SLACK, HORIZON, softening).unwrap();
        let mut desired = frame * relative;
        let outermost = |desired: &Isometry3<f64>| {
            let rooms = workspace.rows(desired).map(|row| row.excess / row.gradient.norm());
            rooms.fold(f64::NEG_INFINITY, f64::max)
        };
        let began = outermost(&desired);
        for _ in 0..120 {
            let mut level = soft.level().unwrap();
            soft.write_rows(&workspace, &desired, level.constraints_mut()).unwrap();
            let hierarchy = hierarchy(&soft, level, 5.0);
            let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
            let x = solver.solve(&hierarchy).unwrap().optimum().unwrap().to_vec();
            desired = integrate_pose(&desired, &Vector6::from_column_slice(&x[1..7]), 0.05);
        }
        let ended = outermost(&desired);
        prop_assert!(ended <= -margin + 1e-4, "{ended} with a margin of {margin}");
        prop_assert!(ended >= began.min(-margin) - 1e-4, "from {began} to {ended}");
    }

    /// If ẋ + ẏ is held at zero, x and y compete. Each gives way in inverse proportion to its
    /// weight.
    #[test]
    fn weights_trade_directions_off(wx in 0.1..10.0_f64, wy in 0.1..10.0_f64) {
        let small = Bounds::symmetric(Vector3::repeat(0.1)).unwrap();
        let workspace = Workspace::new(Isometry3::identity(), small, small).unwrap();
        let weights = Vector6::new(wx, wy, 1.0, 1.0, 1.0, 1.0);
        let softening = Softening { weights, ..Softening::default() };
        let soft = SoftWorkspace::new(SLACK, HORIZON, softening).unwrap();
        let mut level = soft.level().unwrap();
        let desired = Isometry3::translation(0.5, 0.5, 0.0);
        soft.write_rows(&workspace, &desired, level.constraints_mut()).unwrap();
        let mut hierarchy = Hierarchy::new(SLACK.len()).unwrap();
        let mut sum = DMatrix::zeros(1, SLACK.len());
        (sum[(0, 1)], sum[(0, 2)]) = (1.0, 1.0);
        let held = Rows::equalities(&sum, &DVector::zeros(1)).unwrap();
        hierarchy.push(Level::constraints_only(held)).unwrap();
        hierarchy.push(level).unwrap();
        let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
        let x = solver.solve(&hierarchy).unwrap().optimum().unwrap().to_vec();
        let (ex, ey) = (0.4 + HORIZON * x[1], 0.4 + HORIZON * x[2]);
        prop_assert!((wx * ex - wy * ey).abs() < 1e-9, "{ex} {ey}");
    }
}

#[test]
fn unsuitable_workspaces_and_settings_are_named() {
    let unit = Bounds::symmetric(Vector3::repeat(0.5)).unwrap();
    let corners = [Vector3::zeros(), Vector3::x(), Vector3::y(), Vector3::z()];
    let here = Isometry3::identity();
    let mut workspace = Workspace::new(here, Polytope::hull(&corners).unwrap(), unit).unwrap();
    let soft = SoftWorkspace::new(SLACK, HORIZON, Softening::default()).unwrap();
    let mut level = soft.level().unwrap();
    soft.write_rows(&workspace, &here, level.constraints_mut()).unwrap();
    workspace.reshape_position(unit, 1.0).unwrap();
    let crowded = soft.write_rows(&workspace, &here, level.constraints_mut()).unwrap_err();
    assert!(matches!(crowded, Error::TooMany { got: 10, most: 6, .. }), "{crowded}");
    let boxed = Workspace::new(here, unit, unit).unwrap();
    let mut other = Level::constraints_only(Rows::zeros(3, SLACK.len()));
    assert!(matches!(
        soft.write_rows(&boxed, &here, other.constraints_mut()),
        Err(Error::Size { .. })
    ));
    let without_slack = AugmentedState { slack: 0, ..SLACK };
    let error = SoftWorkspace::new(without_slack, HORIZON, Softening::default()).unwrap_err();
    assert!(matches!(error, Error::Size { got: 0, wanted: 6, .. }), "{error}");
    let weights = Vector6::new(1.0, 1.0, 0.0, 1.0, 1.0, 1.0);
    let softening = Softening { weights, ..Softening::default() };
    let error = SoftWorkspace::new(SLACK, HORIZON, softening).unwrap_err();
    assert!(matches!(error, Error::Value { .. }));
}
