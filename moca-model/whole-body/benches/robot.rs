//! Time of single calls from q on, for MOCA with n = 10 and for a humanoid of 31 joints on a floating base.
//!
//! Run `cargo bench -p whole-body --bench robot`; `benches/peers` measures Pinocchio.
#![allow(clippy::unwrap_used, missing_docs)]

use divan::{Bencher, black_box};
use nalgebra::{DMatrix, IsometryMatrix3, Matrix6xX};
use whole_body::{Axes, Base, Data, Description, FrameId, Model};

const MOCA: &str = include_str!("../examples/urdf/moca.urdf");
const HUMANOID: &str = include_str!("../tests/golden/humanoid.urdf");

fn main() {
    divan::main();
}

/// A robot, a state, and memory for results.
struct Bench {
    model: Model,
    data: Data,
    frames: Vec<FrameId>,
    q: Vec<f64>,
    v: Vec<f64>,
    out: Vec<f64>,
    jacobian: Matrix6xX<f64>,
    mass: DMatrix<f64>,
    placements: Vec<IsometryMatrix3<f64>>,
}

impl Bench {
    fn new(urdf: &str, description: &Description, frames: &[&str]) -> Self {
        let model = Model::from_urdf(urdf, description).unwrap();
        let n = model.velocity_count();
        let v: Vec<f64> =
            (0..n).map(|index| 0.3 + 0.05 * f64::from(u8::try_from(index).unwrap())).collect();
        let mut q = model.neutral();
        model.integrate(&mut q, &v).unwrap();
        Self {
            data: Data::new(&model),
            frames: frames.iter().map(|name| model.frame_id(name).unwrap()).collect(),
            q,
            v,
            out: vec![0.0; n],
            jacobian: Matrix6xX::zeros(n),
            mass: DMatrix::zeros(n, n),
            placements: vec![IsometryMatrix3::identity(); model.frame_count()],
            model,
        }
    }

    /// MOCA with its fingers closed.
    fn moca() -> Self {
        let tips = vec!["panda_tcp".to_owned()];
        Self::new(MOCA, &Description { tips, ..Description::default() }, &["panda_tcp"])
    }

    fn humanoid() -> Self {
        let description = Description { base: Base::Floating, ..Description::default() };
        let frames = ["left_sole", "right_sole", "left_palm", "right_palm"];
        Self::new(HUMANOID, &description, &frames)
    }
}

/// The robots by name, as arguments of divan.
#[derive(Debug, Clone, Copy)]
enum Robot {
    Moca,
    Humanoid,
}

const ROBOTS: [Robot; 2] = [Robot::Moca, Robot::Humanoid];

fn bench(bencher: Bencher, robot: Robot, mut call: impl FnMut(&mut Bench)) {
    let mut bench = match robot {
        Robot::Moca => Bench::moca(),
        Robot::Humanoid => Bench::humanoid(),
    };
    bencher.bench_local(move || call(black_box(&mut bench)));
}

#[divan::bench(args = ROBOTS, sample_count = 500, sample_size = 100)]
fn poses(bencher: Bencher, robot: Robot) {
    bench(bencher, robot, |bench| {
        black_box(bench.data.pose(&bench.model, &bench.q).unwrap());
    });
}

#[divan::bench(args = ROBOTS, sample_count = 500, sample_size = 100)]
fn poses_jacobian(bencher: Bencher, robot: Robot) {
    bench(bencher, robot, |bench| {
        let posed = bench.data.pose(&bench.model, &bench.q).unwrap();
        posed.jacobian_into(bench.frames[0], Axes::World, &mut bench.jacobian).unwrap();
        black_box(&posed.placement(bench.frames[0]).unwrap());
    });
}

#[divan::bench(args = ROBOTS, sample_count = 500, sample_size = 100)]
fn poses_jacobian_gravity(bencher: Bencher, robot: Robot) {
    bench(bencher, robot, |bench| {
        let mut posed = bench.data.pose(&bench.model, &bench.q).unwrap();
        posed.jacobian_into(bench.frames[0], Axes::World, &mut bench.jacobian).unwrap();
        posed.gravity_into(&mut bench.out).unwrap();
        black_box(&posed.placement(bench.frames[0]).unwrap());
    });
}

#[divan::bench(args = ROBOTS, sample_count = 500, sample_size = 100)]
fn placements_and_all_jacobians(bencher: Bencher, robot: Robot) {
    bench(bencher, robot, |bench| {
        let posed = bench.data.pose(&bench.model, &bench.q).unwrap();
        posed.placements_into(&mut bench.placements).unwrap();
        for frame in &bench.frames {
            posed.jacobian_into(*frame, Axes::World, &mut bench.jacobian).unwrap();
            black_box(&bench.jacobian);
        }
    });
}

#[divan::bench(args = ROBOTS, sample_count = 500, sample_size = 100)]
fn inverse_dynamics(bencher: Bencher, robot: Robot) {
    bench(bencher, robot, |bench| {
        let posed = bench.data.pose(&bench.model, &bench.q).unwrap();
        let mut moving = posed.moving(&bench.v).unwrap();
        moving.inverse_dynamics_into(&bench.v, &[], &mut bench.out).unwrap();
    });
}

#[divan::bench(args = ROBOTS, sample_count = 500, sample_size = 100)]
fn mass_matrix(bencher: Bencher, robot: Robot) {
    bench(bencher, robot, |bench| {
        let mut posed = bench.data.pose(&bench.model, &bench.q).unwrap();
        posed.mass_matrix_into(&mut bench.mass).unwrap();
    });
}

#[divan::bench(args = ROBOTS, sample_count = 500, sample_size = 100)]
fn forward_dynamics(bencher: Bencher, robot: Robot) {
    bench(bencher, robot, |bench| {
        let posed = bench.data.pose(&bench.model, &bench.q).unwrap();
        let mut moving = posed.moving(&bench.v).unwrap();
        moving.forward_dynamics_into(&bench.v, &[], &mut bench.out).unwrap();
    });
}

#[divan::bench(args = ROBOTS, sample_count = 200, sample_size = 20)]
fn effective_mass(bencher: Bencher, robot: Robot) {
    bench(bencher, robot, |bench| {
        let mut posed = bench.data.pose(&bench.model, &bench.q).unwrap();
        let up = nalgebra::Vector3::z_axis();
        black_box(posed.effective_mass(bench.frames[0], &up).unwrap());
    });
}
