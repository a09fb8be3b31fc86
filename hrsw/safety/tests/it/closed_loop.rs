//! A small robot in closed loop with people who come, go and jump.

use ahqp_core::{
    AugmentedState, Hierarchy, Level, LevelId, Limits, MotionState, Rows, Settings, Solver,
};
use hrsw_safety::{
    ApproachRows, Capsule, JointMotion, MeasuredVelocity, PersonBody, RobotBody,
    SeparationSettings, proximity,
};
use nalgebra::{DMatrix, DVector, Matrix6xX, Vector3};
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

    /// People stand still. The protective distance is kept in every tick, whatever the goal.
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

    /// People jump in front of the moving robot. The problem stays feasible, and the acceleration
    /// limits hold (checked in each step). The robot never approaches by its own motion.
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
