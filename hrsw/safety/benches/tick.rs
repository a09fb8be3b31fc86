//! Time of the rows of one control tick, compared with brute-force queries by parry.
#![allow(clippy::unwrap_used, missing_docs)]

use ahqp_core::{AugmentedState, Level, Limits, MotionState, Rows};
use divan::{Bencher, black_box};
use hrsw::{Bounds, Capsule, SoftWorkspace, Softening, Workspace};
use hrsw_safety::{
    ApproachRows, JointMotion, MeasuredVelocity, PersonBody, RobotBody, SeparationSettings,
    proximity,
};
use nalgebra::{Isometry3, Matrix6xX, Vector3, Vector6};
use parry3d_f64::math::{Pose, Vector};
use parry3d_f64::query;
use parry3d_f64::shape::Capsule as ParryCapsule;

const STATE: AugmentedState = AugmentedState { joints: 10, task: 6, slack: 6 };
const PAIRS: usize = 20;

fn main() {
    divan::main();
}

/// Returns four capsules of an arm and five of a person, a metre away: 20 pairs.
fn bodies() -> (Vec<RobotBody>, Vec<PersonBody>) {
    let capsule = |from: [f64; 3], to: [f64; 3], radius| {
        Capsule::new(Vector3::from(from), Vector3::from(to), radius).unwrap()
    };
    let arm = [
        capsule([0.0, 0.0, 0.5], [0.0, 0.0, 0.8], 0.06),
        capsule([0.0, 0.0, 0.8], [0.2, 0.1, 1.1], 0.06),
        capsule([0.2, 0.1, 1.1], [0.5, 0.0, 1.0], 0.05),
        capsule([0.5, 0.0, 1.0], [0.6, 0.0, 0.9], 0.04),
    ];
    let body = [
        capsule([1.4, 0.0, 0.1], [1.4, 0.0, 0.9], 0.15),
        capsule([1.4, 0.0, 0.9], [1.4, 0.0, 1.4], 0.18),
        capsule([1.4, 0.0, 1.6], [1.4, 0.0, 1.7], 0.12),
        capsule([1.4, 0.2, 1.4], [1.2, 0.2, 1.1], 0.06),
        capsule([1.2, 0.2, 1.1], [0.9, 0.1, 1.1], 0.05),
    ];
    let robot = arm.into_iter().enumerate();
    let robot = robot.map(|(i, capsule)| RobotBody { capsule, joints: 4 + 2 * i }).collect();
    let walking = Some(MeasuredVelocity::exact(Vector3::new(-0.5, 0.1, 0.0)));
    let part = |capsule| PersonBody {
        assumed_speed: 1.6,
        capsule,
        velocity: walking,
        age: 0.0,
        uncertainty: 0.0,
        contact: None,
    };
    (robot, body.map(part).to_vec())
}

fn workspace() -> Workspace {
    let position = Bounds::new(Vector3::new(0.2, -0.5, 0.7), Vector3::new(0.75, 0.2, 1.6)).unwrap();
    let orientation = Bounds::symmetric(Vector3::repeat(0.3)).unwrap();
    let frame = Isometry3::new(Vector3::new(1.4, 0.0, 0.0), Vector3::z() * 3.0);
    let mut workspace = Workspace::new(frame, position, orientation).unwrap();
    workspace.place(frame, Vector6::repeat(0.1)).unwrap();
    workspace
}

struct Tick {
    workspace: Workspace,
    soft: SoftWorkspace,
    level: Level,
    separation: ApproachRows,
    rows: Rows,
    robot: Vec<RobotBody>,
    person: Vec<PersonBody>,
    jacobian: Matrix6xX<f64>,
    limits: [Limits; 16],
}

impl Tick {
    fn new() -> Self {
        let soft = SoftWorkspace::new(STATE, 0.2, Softening::default()).unwrap();
        let separation = ApproachRows::new(STATE, SeparationSettings::default(), PAIRS).unwrap();
        let (robot, person) = bodies();
        Self {
            workspace: workspace(),
            level: soft.level().unwrap(),
            soft,
            rows: separation.rows(),
            separation,
            robot,
            person,
            jacobian: Matrix6xX::from_fn(10, |i, j| (1.0 + i as f64 - 0.7 * j as f64).sin()),
            limits: [Limits::new(-2.0, 2.0, 2.0, 10.0).unwrap(); 16],
        }
    }

    fn separation(&mut self) {
        let velocity = [0.1; 10];
        let motion = JointMotion {
            jacobian: &self.jacobian,
            origin: Vector3::new(0.6, 0.0, 0.9),
            velocity: &velocity,
            braking: None,
            change: None,
            inverse_inertia: None,
        };
        let nearest = self.separation.write(&motion, &self.robot, &self.person, &mut self.rows);
        black_box(nearest.unwrap());
    }

    fn workspace(&mut self) {
        let desired = Isometry3::translation(0.9, 0.1, 1.1);
        self.soft.write_rows(&self.workspace, &desired, self.level.constraints_mut()).unwrap();
    }

    fn limits(&self) {
        for limits in &self.limits {
            let state = MotionState { position: 0.3, velocity: 0.1 };
            black_box(limits.velocity_interval(black_box(state), 1e-3));
        }
    }
}

#[divan::bench]
fn all_rows_of_a_tick(bencher: Bencher) {
    let mut tick = Tick::new();
    bencher.bench_local(|| {
        tick.workspace();
        tick.separation();
        tick.limits();
    });
}

#[divan::bench]
fn workspace_rows(bencher: Bencher) {
    let mut tick = Tick::new();
    bencher.bench_local(|| tick.workspace());
}

#[divan::bench]
fn separation_rows_of_20_pairs(bencher: Bencher) {
    let mut tick = Tick::new();
    bencher.bench_local(|| tick.separation());
}

#[divan::bench]
fn distances_of_20_pairs(bencher: Bencher) {
    let (robot, person) = bodies();
    bencher.bench_local(|| {
        for body in &robot {
            for part in &person {
                black_box(proximity(black_box(&body.capsule), black_box(&part.capsule)));
            }
        }
    });
}

/// Computes only the nearest points, without gradients or rows.
#[divan::bench]
fn parry_closest_points_of_20_pairs(bencher: Bencher) {
    let (robot, person) = bodies();
    let shape = |c: &Capsule| {
        let point = |v: &Vector3<f64>| Vector::new(v.x, v.y, v.z);
        ParryCapsule::new(point(c.start()), point(c.end()), c.radius())
    };
    let robot: Vec<_> = robot.iter().map(|body| shape(&body.capsule)).collect();
    let person: Vec<_> = person.iter().map(|part| shape(&part.capsule)).collect();
    let here = Pose::IDENTITY;
    bencher.bench_local(|| {
        for body in &robot {
            for part in &person {
                let (body, part) = (black_box(body), black_box(part));
                black_box(query::closest_points(&here, body, &here, part, f64::MAX).unwrap());
            }
        }
    });
}
