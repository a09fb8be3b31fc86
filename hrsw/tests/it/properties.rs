//! Properties of all workspaces and motions.

use ahqp_core::{AugmentedState, Hierarchy, Level, Rows, Settings, Solver};
use hrsw::{Bounds, Error, FrameFollower, OrientationShape, SoftWorkspace, Softening, Workspace};
use nalgebra::{DMatrix, DVector, Isometry3, UnitQuaternion, Vector3, Vector6};
use proptest::prelude::*;

fn vector(size: f64) -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(-1.0..1.0_f64).prop_map(move |v| Vector3::from(v) * size)
}

fn pose(reach: f64, angle: f64) -> impl Strategy<Value = Isometry3<f64>> {
    (vector(reach), vector(angle)).prop_map(|(p, v)| Isometry3::new(p, v))
}

fn twist() -> impl Strategy<Value = Vector6<f64>> {
    prop::array::uniform6(-0.5..0.5_f64).prop_map(Vector6::from)
}

fn workspace() -> impl Strategy<Value = Workspace> {
    (pose(3.0, 1.5), twist(), vector(0.5), vector(0.5), vector(0.4), vector(0.5)).prop_map(
        |(frame, twist, a, b, orientation, reference)| {
            let position = Bounds::new(a.inf(&b), a.sup(&b)).unwrap();
            let orientation = Bounds::symmetric(orientation.abs()).unwrap();
            let reference = UnitQuaternion::from_scaled_axis(reference);
            let mut workspace =
                Workspace::new(frame, position, orientation).unwrap().with_reference(reference);
            workspace.place(frame, twist).unwrap();
            workspace
        },
    )
}

proptest! {
    #[test]
    fn a_pose_is_within_if_its_coordinates_are(
        workspace in workspace(), relative in pose(1.0, 1.0),
    ) {
        let pose = workspace.world_from_workspace() * relative;
        let z = workspace.coordinates(&pose);
        let within = (0..3).all(|i| {
            let OrientationShape::Box(orientation) = workspace.orientation_shape() else {
                return false;
            };
            (workspace.position().min()[i]..=workspace.position().max()[i]).contains(&z[i])
                && (orientation.min()[i]..=orientation.max()[i]).contains(&z[3 + i])
        });
        prop_assert_eq!(workspace.contains(&pose), within);
    }

    /// A softened workspace, alone in a hierarchy, moves ẋ_d so that the pose one horizon ahead is
    /// inside without slack. If the velocity is held, the slack is the remaining distance.
    #[test]
    fn the_slack_is_what_the_velocity_cannot_avoid(
        workspace in workspace(), relative in pose(1.0, 0.8), held in any::<bool>(),
    ) {
        let state = AugmentedState { joints: 1, task: 6, slack: 6 };
        let desired = workspace.world_from_workspace() * relative;
        let soft = SoftWorkspace::new(state, 0.2, Softening::default()).unwrap();
        let mut level = soft.level().unwrap();
        soft.write_rows(&workspace, &desired, level.constraints_mut()).unwrap();
        let (linear, turning) =
            (workspace.twist().fixed_rows::<3>(0), workspace.twist().fixed_rows::<3>(3));
        let arm = desired.translation.vector
            - workspace.world_from_workspace().translation.vector;
        let linear = linear + turning.cross(&arm);
        let drift = [linear, turning.into_owned()];
        let mut hierarchy = Hierarchy::new(state.len()).unwrap();
        if held {
            // ẋ_d moves with the workspace, so z stays constant.
            let mut select = DMatrix::zeros(6, state.len());
            for i in 0..6 { select[(i, 1 + i)] = 1.0; }
            let target = DVector::from_iterator(6, drift.iter().flatten().copied());
            let hold = Rows::equalities(&select, &target).unwrap();
            hierarchy.push(Level::constraints_only(hold)).unwrap();
        }
        hierarchy.push(level).unwrap();
        let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
        let x = solver.solve(&hierarchy).unwrap().optimum().unwrap().to_vec();
        let slack = Vector6::from_column_slice(&x[7..]);
        let expected = if held { workspace.violation(&desired).abs() } else { Vector6::zeros() };
        prop_assert!((slack - expected).norm() < 1e-9, "{slack} {expected}");
    }

    #[test]
    fn a_frame_keeps_its_rates_for_every_target(
        targets in prop::collection::vec((pose(2.0, 1.5), twist()), 1..6),
    ) {
        let mut frame = FrameFollower::new(Isometry3::identity()).unwrap();
        for (target, velocity) in targets {
            frame.retarget(target, velocity).unwrap();
            for _ in 0..200 {
                let before = frame.twist();
                frame.advance(1e-3);
                let change = frame.twist() - before;
                prop_assert!(frame.twist().fixed_rows::<3>(0).norm() <= FrameFollower::SPEED + 1e-12);
                prop_assert!(
                    change.fixed_rows::<3>(0).norm() <= FrameFollower::ACCELERATION * 1e-3 + 1e-12);
                prop_assert!(
                    change.fixed_rows::<3>(3).norm() <= FrameFollower::ANGULAR_ACCELERATION * 1e-3 + 1e-12);
            }
        }
    }

    #[test]
    fn a_frame_arrives_without_overshoot(target in pose(2.0, 1.5)) {
        let mut frame =
            FrameFollower::new(Isometry3::identity()).unwrap();
        frame.retarget(target, Vector6::zeros()).unwrap();
        let goal = target.translation.vector;
        let mut nearest = goal.norm();
        for _ in 0..8000 {
            frame.advance(1e-3);
            let distance = (goal - frame.pose().translation.vector).norm();
            prop_assert!(distance <= nearest + 1e-9);
            nearest = nearest.min(distance);
        }
        prop_assert!(nearest < 1e-6);
    }

    #[test]
    fn a_held_frame_stops_where_it_can(target in pose(2.0, 1.5), ticks in 1..800_usize) {
        let mut frame = FrameFollower::new(Isometry3::identity()).unwrap();
        frame.retarget(target, Vector6::zeros()).unwrap();
        for _ in 0..ticks { frame.advance(1e-3); }
        let (from, speed) = (frame.pose().translation.vector, frame.twist().fixed_rows::<3>(0).norm());
        frame.hold();
        for _ in 0..6000 { frame.advance(1e-3); }
        let travelled = (frame.pose().translation.vector - from).norm();
        prop_assert!(travelled <= speed * speed / FrameFollower::ACCELERATION + 1e-3);
        prop_assert!(frame.twist().norm() < 1e-6);
    }

    #[test]
    fn a_frame_keeps_its_limits_of_turning(
        targets in prop::collection::vec((pose(1.0, 3.0), twist(), 1..600_usize), 1..6),
        speed in 0.1..3.0_f64, acceleration in 0.2..6.0_f64,
    ) {
        let frame = FrameFollower::new(Isometry3::identity()).unwrap();
        let mut frame = frame.with_turning(speed, acceleration).unwrap();
        for (target, twist, ticks) in targets {
            frame.reset(*frame.pose()).unwrap();
            frame.retarget(target, twist).unwrap();
            for _ in 0..ticks {
                let before = frame.twist();
                frame.advance(1e-3);
                let rate = frame.twist().fixed_rows::<3>(3).norm();
                let change = (frame.twist() - before).fixed_rows::<3>(3).norm();
                prop_assert!(rate <= speed + 1e-9 && change <= acceleration * 1e-3 + 1e-12);
            }
            // It brakes at its limit: the angle is ω²/(2α).
            frame.hold();
            let begin = *frame.pose();
            let brakes = frame.twist().fixed_rows::<3>(3).norm().powi(2) / (2.0 * acceleration);
            let (mut farthest, mut resting) = (0.0_f64, 0);
            for _ in 0..20_000 {
                frame.advance(1e-3);
                farthest = farthest.max(begin.rotation.angle_to(&frame.pose().rotation));
                resting = if frame.twist().norm() < 1e-9 { resting + 1 } else { 0 };
                if resting == 500 {
                    break;
                }
            }
            if brakes < 2.0 {
                let turned = begin.rotation.angle_to(&frame.pose().rotation);
                prop_assert!((turned - brakes).abs() < 2e-3, "{turned} rad of {brakes}");
                prop_assert!(farthest < 1.1 * brakes + 5e-3, "{farthest} rad of {brakes}");
            }
        }
    }
}

#[test]
fn bad_input_is_named() {
    let nan = Vector3::new(0.0, f64::NAN, 0.0);
    assert!(matches!(Bounds::new(nan, Vector3::zeros()), Err(Error::Value { .. })));
    assert!(matches!(
        Bounds::new(Vector3::new(0.0, 1.0, 0.0), Vector3::zeros()),
        Err(Error::EmptyRange { axis: 1, .. })
    ));
    let unit = Bounds::symmetric(Vector3::repeat(1.0)).unwrap();
    let wide = Bounds::symmetric(Vector3::repeat(3.0)).unwrap();
    let at = Isometry3::identity();
    assert!(matches!(Workspace::new(at, unit, wide), Err(Error::Value { .. })));
    let nowhere = Isometry3::translation(f64::INFINITY, 0.0, 0.0);
    assert!(matches!(Workspace::new(nowhere, unit, unit), Err(Error::Value { .. })));
    let state = AugmentedState { joints: 10, task: 6, slack: 0 };
    let error = SoftWorkspace::new(state, 0.1, Softening::default()).unwrap_err();
    assert!(error.to_string().contains("slack"), "{error}");
    let state = AugmentedState { joints: 10, task: 6, slack: 6 };
    assert!(matches!(
        SoftWorkspace::new(state, 0.0, Softening::default()),
        Err(Error::Value { .. })
    ));
    let error = FrameFollower::new(at).unwrap().with_speed(-1.0).unwrap_err();
    assert!(error.to_string().contains("speed"), "{error}");
    let error = FrameFollower::new(at).unwrap().with_turning(1.0, 0.0).unwrap_err();
    assert!(error.to_string().contains("angular acceleration"), "{error}");

    let mut frame = FrameFollower::new(at).unwrap();
    assert!(frame.retarget(nowhere, Vector6::zeros()).is_err());
    frame.advance(1e-3);
    assert_eq!(*frame.pose(), at);
}
