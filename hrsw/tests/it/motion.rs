//! Workspaces in motion are always continuous, and reach their goals.

use crate::support::*;
use hrsw::{
    Attachment, Bounds, FrameFollower, MovingWorkspace, OrientationShape, Path, PositionShape,
    Workspace,
};
use nalgebra::{Isometry3, UnitQuaternion, Vector3, Vector6};
use proptest::prelude::*;

const PERIOD: f64 = 1e-3;

/// Events of a moving workspace.
#[derive(Debug, Clone)]
enum Event {
    Attach(Attachment),
    Detach,
    Person(Isometry3<f64>, Vector6<f64>),
    Lead(Vector3<f64>),
    Reorient(UnitQuaternion<f64>, Vector3<f64>),
    Position(PositionShape, f64),
    Orientation(OrientationShape, f64),
}

fn event() -> impl Strategy<Value = Event> {
    let path = (prop::collection::vec(pose(1.0, 1.5), 1..5), 0.05..0.8_f64)
        .prop_map(|(waypoints, speed)| Attachment::Path(Path::new(&waypoints, speed).unwrap()));
    let attachment = prop_oneof![
        pose(1.0, 1.5).prop_map(Attachment::World),
        pose(1.0, 1.5).prop_map(Attachment::Person),
        path,
    ];
    prop_oneof![
        2 => attachment.prop_map(Event::Attach),
        1 => Just(Event::Detach),
        4 => (pose(2.0, 1.5), twist()).prop_map(|(p, v)| Event::Person(p, v)),
        1 => vector(0.5).prop_map(Event::Lead),
        1 => (rotation(), direction()).prop_map(|(goal, axis)| Event::Reorient(goal, axis)),
        1 => (position_shape(), 0.1..1.0_f64).prop_map(|(s, t)| Event::Position(s, t)),
        1 => (orientation_shape(), 0.1..1.0_f64).prop_map(|(s, t)| Event::Orientation(s, t)),
    ]
}

fn happens(event: Event, moving: &mut MovingWorkspace) {
    match event {
        Event::Attach(attachment) => moving.attach(attachment).unwrap(),
        Event::Detach => moving.detach(),
        Event::Person(pose, twist) => moving.set_person(pose, twist).unwrap(),
        Event::Lead(lead) => moving.set_lead(lead).unwrap(),
        Event::Reorient(goal, axis) => {
            moving.reorient(goal, &nalgebra::Unit::new_normalize(axis)).unwrap();
        }
        Event::Position(shape, time) => moving.reshape_position(&shape, time).unwrap(),
        Event::Orientation(shape, time) => moving.reshape_orientation(&shape, time).unwrap(),
    }
}

fn box_workspace() -> Workspace {
    let position = Bounds::new(Vector3::new(0.2, -0.5, 0.7), Vector3::new(0.75, 0.2, 1.6)).unwrap();
    let orientation = Bounds::symmetric(Vector3::repeat(0.3)).unwrap();
    Workspace::new(Isometry3::identity(), position, orientation).unwrap()
}

fn moving() -> MovingWorkspace {
    MovingWorkspace::new(box_workspace(), FrameFollower::SPEED).unwrap()
}

fn run(moving: &mut MovingWorkspace, ticks: usize) {
    for _ in 0..ticks {
        moving.advance(PERIOD).unwrap();
    }
}

/// Returns the largest excess of a pose, zero inside.
fn excess(workspace: &Workspace, pose: &Isometry3<f64>) -> f64 {
    workspace.rows(pose).map(|row| row.excess).fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn velocities_and_bounds_are_always_continuous(
        events in prop::collection::vec((event(), 1..120_usize), 1..16), at in pose(1.0, 0.5),
    ) {
        let mut moving = moving();
        for (event, ticks) in events {
            happens(event, &mut moving);
            for _ in 0..ticks {
                let before = moving.workspace().clone();
                moving.advance(PERIOD).unwrap();
                let after = moving.workspace();
                let change = after.twist() - before.twist();
                let linear = change.fixed_rows::<3>(0).norm();
                let angular = change.fixed_rows::<3>(3).norm();
                prop_assert!(linear <= FrameFollower::ACCELERATION * PERIOD + 1e-12);
                prop_assert!(angular <= FrameFollower::ANGULAR_ACCELERATION * PERIOD + 1e-12);
                let turn = (after.reference_rate() - before.reference_rate()).norm();
                prop_assert!(turn <= FrameFollower::ANGULAR_ACCELERATION * PERIOD + 1e-12);
                // Speeds of frame (at an arm of at most 6 m), reference and bounds, with a margin.
                let relative = (excess(after, &at) - excess(&before, &at)).abs();
                let far = before.coordinates(&at).fixed_rows::<3>(3).norm() > 2.5;
                prop_assert!(relative <= 150.0 * PERIOD || far, "{relative}");
            }
        }
    }

    #[test]
    fn a_workspace_arrives_at_what_carries_it(
        offset in pose(0.5, 1.0), person in pose(1.0, 1.0), lead in vector(0.3),
    ) {
        let mut moving = moving();
        moving.attach(Attachment::Person(offset)).unwrap();
        run(&mut moving, 100);
        prop_assert_eq!(moving.workspace().world_from_workspace(), &Isometry3::identity());
        moving.set_person(person, Vector6::zeros()).unwrap();
        moving.set_lead(lead).unwrap();
        run(&mut moving, 8000);
        let expected = person * nalgebra::Translation3::from(lead) * offset;
        let error = ahqp_core::pose_error(&expected, moving.workspace().world_from_workspace());
        prop_assert!(error.norm() < 1e-6, "{error}");
        moving.detach();
        moving.set_person(Isometry3::identity(), Vector6::zeros()).unwrap();
        run(&mut moving, 1000);
        let stayed = ahqp_core::pose_error(&expected, moving.workspace().world_from_workspace());
        prop_assert!(stayed.norm() < 1e-5, "{stayed}");
    }

    /// The velocity of the carrier is fed forward, at the frame's own place.
    #[test]
    fn a_frame_keeps_up_with_a_turning_carrier(
        offset in pose(1.0, 1.0), velocity in vector(0.2), turning in -0.4..0.4_f64,
    ) {
        let mut moving = moving();
        moving.attach(Attachment::Person(offset)).unwrap();
        let twist = Vector6::new(velocity.x, velocity.y, velocity.z, 0.0, 0.0, turning);
        let mut carrier = Isometry3::identity();
        for _ in 0..6000 {
            carrier = ahqp_core::integrate_pose(&carrier, &twist, PERIOD);
            moving.set_person(carrier, twist).unwrap();
            moving.advance(PERIOD).unwrap();
        }
        let error = ahqp_core::pose_error(
            &(carrier * offset), moving.workspace().world_from_workspace());
        prop_assert!(error.norm() < 5e-3, "{error}");
    }

    /// The person's frame goes on for the period for which it was set.
    #[test]
    fn a_person_not_set_again_stands(velocity in vector(0.8), ticks in 1..500_usize) {
        let mut moving = moving();
        moving.attach(Attachment::Person(Isometry3::identity())).unwrap();
        let twist = Vector6::new(velocity.x, velocity.y, velocity.z, 0.0, 0.0, 0.0);
        for tick in 0..ticks {
            let at = velocity * (tick as f64 * PERIOD);
            moving.set_person(Isometry3::from(at), twist).unwrap();
            moving.advance(PERIOD).unwrap();
        }
        run(&mut moving, 8000);
        let end = velocity * (ticks as f64 * PERIOD);
        let error = moving.workspace().world_from_workspace().translation.vector - end;
        prop_assert!(error.norm() < 1e-6, "{error}");
    }

    #[test]
    fn a_path_is_continuous_and_passes_its_waypoints(
        waypoints in prop::collection::vec(pose(1.0, 1.5), 1..6), speed in 0.05..1.0_f64,
    ) {
        let path = Path::new(&waypoints, speed).unwrap();
        let near = |a: &Isometry3<f64>, b: &Isometry3<f64>| ahqp_core::pose_error(a, b).norm();
        prop_assert!(near(&path.at(-1.0).0, &waypoints[0]) < 1e-9);
        prop_assert!(near(&path.at(path.duration() + 1.0).0, waypoints.last().unwrap()) < 1e-9);
        let steps = 2000;
        let step = path.duration() / f64::from(steps);
        let mut nearest = vec![f64::INFINITY; waypoints.len()];
        for i in 0..=steps {
            let time = step * f64::from(i);
            let (pose, twist) = path.at(time);
            let (next, _) = path.at(time + 1e-7);
            prop_assert!(near(&next, &pose) < 1e-6 * (1.0 + speed / 0.3));
            prop_assert!(twist.fixed_rows::<3>(0).norm() <= speed + 1e-9);
            for (nearest, waypoint) in nearest.iter_mut().zip(&waypoints) {
                *nearest = nearest.min(near(&pose, waypoint));
            }
        }
        prop_assert!(nearest.iter().all(|&d| d <= step * speed * (1.0 + 1.0 / 0.3) + 1e-9));
    }

    /// Between any two shapes every bound moves with its drift, and the set is never empty. It
    /// equals each shape at its end.
    #[test]
    fn changes_of_shape_are_continuous_and_never_empty(
        from in position_shape(), to in position_shape(),
        turn in (orientation_shape(), orientation_shape()), at in pose(0.8, 0.8),
    ) {
        let mut workspace = Workspace::new(Isometry3::identity(), from.clone(), turn.0).unwrap();
        // Planes that only touch the shape are added at the beginning, and cut nothing off.
        let (within, mut last) = (workspace.contains(&at), excess(&workspace, &at));
        workspace.reshape_position(to.clone(), 1.0).unwrap();
        prop_assert_eq!(workspace.contains(&at), within);
        workspace.reshape_orientation(turn.1, 1.0).unwrap();
        let inside = (from.nearest(&from.extent().center()), to.nearest(&to.extent().center()));
        for tick in 0..1000_u32 {
            let u = f64::from(tick) * PERIOD;
            let share = u * u * u * (10.0 + u * (6.0 * u - 15.0));
            let between = inside.0.lerp(&inside.1, share);
            let point = Isometry3::translation(between.x, between.y, between.z);
            let linear = |workspace: &Workspace, pose: &Isometry3<f64>| -> Vec<(f64, f64)> {
                let positions = workspace.row_counts().0;
                workspace.rows(pose).take(positions).map(|row| (row.excess, row.drift)).collect()
            };
            prop_assert!(linear(&workspace, &point).iter().all(|&(excess, _)| excess < 1e-6));
            let rows = linear(&workspace, &at);
            prop_assert!(workspace.is_changing());
            workspace.advance(PERIOD);
            let later = linear(&workspace, &at);
            if workspace.is_changing() {
                for (now, later) in rows.iter().zip(&later) {
                    prop_assert!((later.0 - now.0 - now.1 * PERIOD).abs() < 1e-3);
                }
            }
            let now = excess(&workspace, &at);
            prop_assert!((now - last).abs() < 0.05, "{last} {now}");
            last = now;
        }
        workspace.advance(PERIOD);
        prop_assert!(!workspace.is_changing());
        let expected = Workspace::new(Isometry3::identity(), to, turn.1).unwrap();
        prop_assert_eq!(workspace, expected);
    }

    #[test]
    fn a_half_turn_keeps_its_rate_and_sense(
        axis in direction(), sense in any::<bool>(), wobble in vector(1e-6),
    ) {
        let mut moving = moving();
        let goal = UnitQuaternion::from_scaled_axis(axis * std::f64::consts::PI + wobble);
        let about = nalgebra::Unit::new_normalize(if sense { axis } else { -axis });
        moving.reorient(goal, &about).unwrap();
        for _ in 0..8000 {
            moving.advance(PERIOD).unwrap();
            let rate = moving.workspace().reference_rate();
            prop_assert!(rate.norm() <= FrameFollower::ANGULAR_SPEED + 1e-12);
            prop_assert!(rate.dot(&about) >= -1e-6, "turns back");
        }
        prop_assert!(moving.workspace().reference().angle_to(&goal) < 1e-6);
        let within = UnitQuaternion::from_scaled_axis(Vector3::repeat(0.1));
        let held = Isometry3::from_parts(Vector3::new(0.5, 0.0, 1.0).into(), goal * within);
        prop_assert!(moving.workspace().contains(&held));
    }

    #[test]
    fn a_workspace_approaches_a_new_carrier_slowly(
        way in vector(1.5), heading in -3.0..3.0_f64, speed in 0.0..0.6_f64,
    ) {
        let velocity = Vector3::new(heading.cos(), heading.sin(), 0.0) * speed;
        let twist = Vector6::new(velocity.x, velocity.y, 0.0, 0.0, 0.0, 0.0);
        let mut moving = moving();
        moving.attach(Attachment::Person(Isometry3::identity())).unwrap();
        let fastest = (way.norm() / 2.0).max(0.35) + 1e-3;
        let (mut arrived, mut before) = (false, way);
        for tick in 0..9000 {
            let carrier = way + velocity * (f64::from(tick) * PERIOD);
            moving.set_person(Isometry3::from(carrier), twist).unwrap();
            moving.advance(PERIOD).unwrap();
            let left = carrier - moving.workspace().world_from_workspace().translation.vector;
            // From rest it first takes up the carrier's motion.
            let closes = (left - before).norm();
            prop_assert!(arrived || tick < 400 || closes <= fastest * PERIOD + 1e-9, "closes too fast");
            arrived |= left.norm() <= 0.05;
            before = left;
        }
        prop_assert!(before.norm() < 0.02, "{} m behind", before.norm());
    }
}

/// Generates arbitrary bits: numbers of every size, infinities and NaN.
fn wild() -> impl Strategy<Value = f64> {
    prop_oneof![prop::num::f64::ANY, -1.0..1.0_f64]
}

fn wild_pose() -> impl Strategy<Value = Isometry3<f64>> {
    (prop::array::uniform3(wild()), prop::array::uniform4(wild()), any::<bool>()).prop_map(
        |(p, q, unit)| {
            let q = nalgebra::Quaternion::new(q[0], q[1], q[2], q[3]);
            let rotation =
                if unit { UnitQuaternion::identity() } else { UnitQuaternion::new_unchecked(q) };
            Isometry3::from_parts(Vector3::from(p).into(), rotation)
        },
    )
}

proptest! {
    /// A workspace stays valid for all inputs, accepted or refused.
    #[test]
    fn a_running_workspace_never_becomes_invalid(
        poses in prop::collection::vec(wild_pose(), 12),
        twists in prop::collection::vec(prop::array::uniform6(wild()), 12),
        numbers in prop::collection::vec(wild(), 12),
    ) {
        let mut moving = moving();
        let at = Isometry3::identity();
        let soft = hrsw::SoftWorkspace::new(
            ahqp_core::AugmentedState { joints: 10, task: 6, slack: 6 }, 0.2, hrsw::Softening::default()).unwrap();
        let mut level = soft.level().unwrap();
        moving.attach(Attachment::Person(at)).unwrap();
        for ((pose, twist), number) in poses.into_iter().zip(twists).zip(numbers) {
            let twist = Vector6::from(twist);
            let _ = moving.set_person(pose, twist);
            let _ = moving.set_lead(pose.translation.vector);
            let _ = moving.reorient(pose.rotation, &Vector3::z_axis());
            let _ = moving.attach(Attachment::World(pose));
            let _ = moving.advance(number);
            run(&mut moving, 3);
            let workspace = moving.workspace();
            let frame = workspace.world_from_workspace();
            prop_assert!(frame.translation.vector.iter().all(|x| x.is_finite()));
            prop_assert!((frame.rotation.coords.norm() - 1.0).abs() < 1e-9);
            prop_assert!(workspace.twist().iter().all(|x| x.is_finite()));
            prop_assert!((workspace.reference().coords.norm() - 1.0).abs() < 1e-9);
            prop_assert!(workspace.rows(&at).all(|row| row.excess.is_finite() && row.drift.is_finite()));
            prop_assert!(soft.write_rows(workspace, &at, level.constraints_mut()).is_ok());
        }
    }
}

#[test]
fn bad_motion_is_named_and_changes_nothing() {
    let mut moving = moving();
    let before = moving.clone();
    let nowhere = Isometry3::translation(f64::NAN, 0.0, 0.0);
    let rest = Vector6::zeros();
    assert!(moving.attach(Attachment::World(nowhere)).is_err());
    assert!(moving.set_person(nowhere, rest).is_err());
    assert!(moving.set_person(Isometry3::identity(), rest * f64::NAN).is_err());
    assert!(moving.set_lead(Vector3::repeat(f64::INFINITY)).is_err());
    assert_eq!(moving, before);
    assert!(Path::new(&[], 1.0).is_err());
    assert!(Path::new(&[nowhere], 1.0).is_err());
    assert!(Path::new(&[Isometry3::identity()], 0.0).is_err());
}
