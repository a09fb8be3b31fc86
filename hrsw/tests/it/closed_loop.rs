//! A desired pose in closed loop with a workspace that moves with people who come, go and jump.

use ahqp_core::{
    AugmentedState, Hierarchy, Level, LevelId, Limits, MotionState, Rows, Settings, Solver,
};
use hrsw::{
    Attachment, Bounds, Capsule, Cone, FrameFollower, MovingWorkspace, OrientationShape,
    PositionShape, SoftWorkspace, Softening, Workspace,
};
use nalgebra::{DMatrix, DVector, Isometry3, Vector3, Vector6};
use proptest::prelude::*;

const PERIOD: f64 = 2e-3;
const DESIRED: AugmentedState = AugmentedState { joints: 1, task: 6, slack: 6 };
/// Largest acceleration of ẋ_d \[m/s², rad/s²\].
const DESIRED_ACCELERATION: f64 = 6.0;

/// The variable x_d alone, kept in a moving workspace and otherwise at rest.
struct Desired {
    pose: Isometry3<f64>,
    twist: Vector6<f64>,
    limits: Limits,
    soft: SoftWorkspace,
    hierarchy: Hierarchy,
    inside: LevelId,
    solver: Solver,
}

impl Desired {
    fn new() -> Self {
        let room = Softening { position_rows: 13, ..Softening::default() };
        let soft = SoftWorkspace::new(DESIRED, 0.3, room).unwrap();
        let mut hierarchy = Hierarchy::new(DESIRED.len()).unwrap();
        let inside = hierarchy.push(soft.level().unwrap()).unwrap();
        let rest = DMatrix::from_fn(6, DESIRED.len(), |i, j| if j == i + 1 { 1.0 } else { 0.0 });
        let rest = Rows::equalities(&rest, &DVector::zeros(6)).unwrap();
        hierarchy.push(Level::least_squares(rest)).unwrap();
        let free = (f64::NEG_INFINITY, f64::INFINITY);
        Self {
            pose: Isometry3::translation(0.5, 0.0, 1.0),
            twist: Vector6::zeros(),
            limits: Limits::new(free.0, free.1, 1.8, DESIRED_ACCELERATION).unwrap(),
            soft,
            inside,
            solver: Solver::new(&hierarchy, Settings::default()).unwrap(),
            hierarchy,
        }
    }

    fn step(&mut self, workspace: &Workspace) {
        let (lower, upper) = self.hierarchy.bounds_mut();
        for (axis, index) in DESIRED.desired_velocity().enumerate() {
            let at = MotionState { position: 0.0, velocity: self.twist[axis] };
            let interval = self.limits.velocity_interval(at, PERIOD);
            (lower[index], upper[index]) = (interval.lower, interval.upper);
        }
        self.soft
            .write_rows(workspace, &self.pose, self.hierarchy.constraints_mut(self.inside).unwrap())
            .unwrap();
        let solution = self.solver.solve(&self.hierarchy).unwrap();
        let twist =
            Vector6::from_column_slice(&solution.optimum().unwrap()[DESIRED.desired_velocity()]);
        assert!((twist - self.twist).amax() <= DESIRED_ACCELERATION * PERIOD + 1e-9);
        self.twist = twist;
        self.pose = ahqp_core::integrate_pose(&self.pose, &self.twist, PERIOD);
    }
}

fn moving() -> MovingWorkspace {
    let position = Bounds::new(Vector3::new(0.2, -0.5, 0.7), Vector3::new(0.8, 0.3, 1.5)).unwrap();
    let turn = Bounds::symmetric(Vector3::repeat(0.3)).unwrap();
    let workspace = Workspace::new(Isometry3::identity(), position, turn).unwrap();
    let mut moving = MovingWorkspace::new(workspace, FrameFollower::SPEED).unwrap();
    moving.attach(Attachment::Person(Isometry3::identity())).unwrap();
    moving
}

fn point(size: f64) -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(-1.0..1.0_f64).prop_map(move |v| Vector3::from(v) * size)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// The person jumps or is lost, and shapes change. The problem has a solution in every tick,
    /// and ẋ_d stays continuous (both checked in each step).
    #[test]
    fn the_desired_motion_is_continuous_through_every_transition(
        events in prop::collection::vec(
            (point(1.4), -3.0..3.0_f64, point(0.8), 0..4_usize, 1..300_usize), 1..12),
    ) {
        let mut moving = moving();
        let mut desired = Desired::new();
        let bounds = Bounds::new(Vector3::new(0.1, -0.3, 0.6), Vector3::new(0.6, 0.4, 1.3)).unwrap();
        let ball = Capsule::sphere(Vector3::new(0.5, 0.0, 1.0), 0.3).unwrap();
        let cone = Cone::new(Vector3::z(), Vector3::z(), 0.3).unwrap();
        for (at, yaw, velocity, what, ticks) in events {
            let person = Isometry3::new(Vector3::new(at.x, at.y, 0.0), Vector3::z() * yaw);
            let twist = Vector6::new(velocity.x, velocity.y, 0.0, 0.0, 0.0, velocity.z);
            match what {
                0 => moving.reshape_position(&PositionShape::from(bounds), 0.3).unwrap(),
                1 => moving.reshape_position(&PositionShape::from(ball), 0.3).unwrap(),
                2 => moving.reshape_orientation(&OrientationShape::from(cone), 0.3).unwrap(),
                // The person is out of sight for some time.
                _ => for _ in 0..200 {
                    moving.advance(PERIOD).unwrap();
                    desired.step(moving.workspace());
                },
            }
            for tick in 0..ticks {
                let now = ahqp_core::integrate_pose(&person, &twist, tick as f64 * PERIOD);
                moving.set_person(now, twist).unwrap();
                moving.advance(PERIOD).unwrap();
                desired.step(moving.workspace());
            }
        }
        for _ in 0..4000 {
            moving.advance(PERIOD).unwrap();
            desired.step(moving.workspace());
        }
        prop_assert!(moving.workspace().violation(&desired.pose).norm() < 1e-4);
    }

    /// A person walks on. The workspace feeds its velocity forward, and x_d stays inside.
    #[test]
    fn a_walking_person_keeps_the_desired_pose_within(
        direction in -3.1..3.1_f64, speed in 0.1..0.8_f64, turning in -0.3..0.3_f64,
    ) {
        let mut moving = moving();
        let mut desired = Desired::new();
        let here = Isometry3::identity();
        let twist =
            Vector6::new(speed * direction.cos(), speed * direction.sin(), 0.0, 0.0, 0.0, turning);
        for tick in 0..5000_usize {
            let now = ahqp_core::integrate_pose(&here, &twist, tick as f64 * PERIOD);
            moving.set_person(now, twist).unwrap();
            moving.advance(PERIOD).unwrap();
            desired.step(moving.workspace());
            if tick > 2500 {
                let outside = moving.workspace().violation(&desired.pose).norm();
                prop_assert!(outside < 2e-3, "{outside}");
            }
        }
    }
}
