//! A small robot in closed loop with people who come, go and jump.

use ahqp_core::{
    AugmentedState, Hierarchy, Level, LevelId, Limits, MotionState, Rows, Settings, Solver,
};
use hrsw::{
    ApproachRows, Attachment, Bounds, Capsule, Cone, JointMotion, MeasuredVelocity, MovingSettings,
    MovingWorkspace, OrientationShape, PersonBody, PositionShape, RobotBody, SeparationSettings,
    SoftWorkspace, Softening, Workspace, proximity,
};
use nalgebra::{DMatrix, DVector, Isometry3, Matrix6xX, Vector3, Vector6};
use proptest::prelude::*;

const PERIOD: f64 = 2e-3;
const STATE: AugmentedState = AugmentedState { joints: 3, task: 0, slack: 0 };
const ACCELERATION: f64 = 3.0;

/// A tool that slides along x, y and z.
struct Gantry {
    position: Vector3<f64>,
    velocity: Vector3<f64>,
    jacobian: Matrix6xX<f64>,
    limits: Limits,
    hierarchy: Hierarchy,
    apart: LevelId,
    reach: LevelId,
    solver: Solver,
    separation: ApproachRows,
}

#[derive(Debug, PartialEq)]
enum Kind {
    /// Rows as a first level of their own.
    Level,
    /// Hard rows, relaxed to admit braking.
    Hard,
}

impl Gantry {
    fn new(kind: &Kind) -> Self {
        let settings =
            SeparationSettings { deceleration: ACCELERATION, ..SeparationSettings::default() };
        let separation = ApproachRows::new(STATE, settings, 4).unwrap();
        let mut jacobian = Matrix6xX::zeros(3);
        jacobian.view_mut((0, 0), (3, 3)).fill_with_identity();
        let mut hierarchy = Hierarchy::new(3).unwrap();
        let apart = hierarchy
            .push(match kind {
                Kind::Level => Level::least_squares(separation.rows()),
                Kind::Hard => Level::constraints_only(separation.rows()),
            })
            .unwrap();
        let goal = Rows::equalities(&DMatrix::identity(3, 3), &DVector::zeros(3)).unwrap();
        let reach = hierarchy.push(Level::least_squares(goal)).unwrap();
        Self {
            apart,
            reach,
            position: Vector3::zeros(),
            velocity: Vector3::zeros(),
            jacobian,
            limits: Limits::new(f64::NEG_INFINITY, f64::INFINITY, 1.5, ACCELERATION).unwrap(),
            solver: Solver::new(&hierarchy, Settings::default()).unwrap(),
            hierarchy,
            separation,
        }
    }

    fn body(&self) -> RobotBody {
        RobotBody { capsule: Capsule::sphere(self.position, 0.1).unwrap(), joints: 3 }
    }

    fn step(&mut self, kind: &Kind, goal: &Vector3<f64>, person: &[PersonBody]) {
        let mut braking = [0.0; 3];
        for axis in 0..3 {
            let at = MotionState { position: 0.0, velocity: self.velocity[axis] };
            let interval = self.limits.velocity_interval(at, PERIOD);
            braking[axis] = 0.0_f64.clamp(interval.lower, interval.upper);
            let (lower, upper) = self.hierarchy.bounds_mut();
            lower[axis] = interval.lower;
            upper[axis] = interval.upper;
        }
        let robot = [self.body()];
        let motion = JointMotion {
            jacobian: &self.jacobian,
            origin: self.position,
            velocity: self.velocity.as_slice(),
            braking: (*kind == Kind::Hard).then_some(&braking),
            change: None,
            inverse_inertia: None,
        };
        let rows = match kind {
            Kind::Level => self.hierarchy.rows_mut(self.apart).unwrap(),
            Kind::Hard => self.hierarchy.constraints_mut(self.apart).unwrap(),
        };
        self.separation.write(&motion, &robot, person, rows).unwrap();
        let wanted = (goal - self.position) * 5.0;
        self.hierarchy.rows_mut(self.reach).unwrap().set_targets(&wanted).unwrap();
        let solution = self.solver.solve(&self.hierarchy).unwrap();
        let velocity = Vector3::from_column_slice(solution.optimum().unwrap());
        assert!((velocity - self.velocity).amax() <= ACCELERATION * PERIOD + 1e-9);
        self.velocity = velocity;
        self.position += velocity * PERIOD;
    }
}

fn point(size: f64) -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(-1.0..1.0_f64).prop_map(move |v| Vector3::from(v) * size)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// People who stand: whatever the goal, the protective distance is kept in every tick.
    #[test]
    fn the_protective_distance_to_standing_people_is_kept(
        people in prop::collection::vec(point(2.0), 1..4),
        goals in prop::collection::vec(point(2.5), 1..5),
    ) {
        let still = |at: &Vector3<f64>| PersonBody { assumed_speed: 1.6,
            capsule: Capsule::new(*at, at + Vector3::z() * 0.4, 0.2).unwrap(),
            velocity: Some(MeasuredVelocity::exact(Vector3::zeros())),
            age: 0.0,
            uncertainty: 0.0,
            contact: None,
        };
        let person: Vec<PersonBody> = people.iter().map(still).collect();
        let kind = Kind::Level;
        let mut gantry = Gantry::new(&kind);
        let settings = *gantry.separation.settings();
        let starts_near = person.iter().any(|part| {
            proximity(&gantry.body().capsule, &part.capsule).distance
                < settings.protective_distance(0.0, 0.0)
        });
        prop_assume!(!starts_near);
        for goal in goals {
            for _ in 0..600 {
                let body = gantry.body().capsule;
                gantry.step(&kind, &goal, &person);
                for part in &person {
                    let near = proximity(&body, &part.capsule);
                    let approach = -near.normal.dot(&gantry.velocity);
                    let required = settings.protective_distance(0.0, approach);
                    prop_assert!(near.distance >= required - 1e-6, "{} {required}", near.distance);
                }
            }
        }
    }

    /// People who jump in front of the moving robot: always feasible, always within the
    /// acceleration limits (checked in each step), and never nearer by the robot's will.
    #[test]
    fn jumps_never_make_the_problem_infeasible(
        jumps in prop::collection::vec((point(1.0), point(2.0), point(2.5), 1..300_usize), 1..12),
        level in any::<bool>(),
    ) {
        let kind = if level { Kind::Level } else { Kind::Hard };
        let mut gantry = Gantry::new(&kind);
        for (at, velocity, goal, ticks) in jumps {
            let person = [
                PersonBody { assumed_speed: 1.6,
                    capsule: Capsule::sphere(gantry.position + at, 0.3).unwrap(),
                    velocity: Some(MeasuredVelocity::exact(velocity)),
                    age: 0.0,
                    uncertainty: 0.0,
                    contact: None,
                },
                PersonBody { assumed_speed: 1.6,
                    capsule: Capsule::new(at, goal, 0.1).unwrap(),
                    velocity: None,
                    age: 0.0,
                    uncertainty: 0.0,
                    contact: None,
                },
            ];
            for _ in 0..ticks {
                gantry.step(&kind, &goal, &person);
                prop_assert!(gantry.position.iter().all(|x| x.is_finite()));
            }
        }
    }
}

const DESIRED: AugmentedState = AugmentedState { joints: 1, task: 6, slack: 6 };
/// Of ẋ_d \[m/s², rad/s²\].
const DESIRED_ACCELERATION: f64 = 6.0;

/// x_d alone, held in a moving workspace and else at rest.
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
        let soft = SoftWorkspace::with_softening(DESIRED, 0.3, room).unwrap();
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
            .write(workspace, &self.pose, self.hierarchy.level_mut(self.inside).unwrap())
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
    let mut moving = MovingWorkspace::new(workspace, MovingSettings::default()).unwrap();
    moving.attach(Attachment::Person(Isometry3::identity())).unwrap();
    moving
}

/// A person as seen by a camera at 20 Hz, a tenth of a second late.
fn observe(moving: &mut MovingWorkspace, from: &Isometry3<f64>, twist: &Vector6<f64>, time: f64) {
    let seen = ahqp_core::integrate_pose(from, twist, time - 0.1);
    moving.observe_person(seen, *twist, 0.1).unwrap();
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Jumps, losses and changes of shape: the problem has a solution in every tick, and ẋ_d
    /// stays continuous (both checked in each step).
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
                // Out of sight for a while.
                _ => for _ in 0..200 {
                    moving.advance(PERIOD).unwrap();
                    desired.step(moving.workspace());
                },
            }
            for tick in 0..ticks {
                if tick % 25 == 0 {
                    observe(&mut moving, &person, &twist, tick as f64 * PERIOD);
                }
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

    /// A person who walks on: the workspace feeds its velocity forward, and x_d stays within.
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
            if tick % 25 == 0 {
                observe(&mut moving, &here, &twist, tick as f64 * PERIOD);
            }
            moving.advance(PERIOD).unwrap();
            desired.step(moving.workspace());
            if tick > 2500 {
                let outside = moving.workspace().violation(&desired.pose).norm();
                prop_assert!(outside < 2e-3, "{outside}");
            }
        }
    }
}
