//! Time of single calls for MOCA, n = 10, from q on.
//!
//! Run `cargo bench -p moca-model`.
#![allow(clippy::unwrap_used, missing_docs)]

use divan::{Bencher, black_box};
use moca_model::whole_body::{Axes, Data, FrameId, Model};
use moca_model::{Kinematics, MOCA_HOME, MOCA_TOOL, moca, moca_safety};
use nalgebra::Matrix6xX;

fn main() {
    divan::main();
}

/// The robot, a configuration and memory for results.
struct Bench {
    model: Model,
    data: Data,
    tool: FrameId,
    q: [f64; 10],
    jacobian: Matrix6xX<f64>,
    gravity: [f64; 10],
}

fn bench(bencher: Bencher, mut call: impl FnMut(&mut Bench)) {
    let model = moca().unwrap();
    let mut bench = Bench {
        data: Data::new(&model),
        tool: model.frame_id(MOCA_TOOL).unwrap(),
        q: MOCA_HOME.map(|position| position + 0.1),
        jacobian: Matrix6xX::zeros(10),
        gravity: [0.0; 10],
        model,
    };
    bencher.bench_local(move || call(black_box(&mut bench)));
}

#[divan::bench(sample_count = 500, sample_size = 100)]
fn fk(bencher: Bencher) {
    bench(bencher, |Bench { model, data, tool, q, .. }| {
        black_box(data.pose(model, q).unwrap().world_from(*tool).unwrap());
    });
}

#[divan::bench(sample_count = 500, sample_size = 100)]
fn fk_jacobian(bencher: Bencher) {
    bench(bencher, |Bench { model, data, tool, q, jacobian, .. }| {
        let posed = data.pose(model, q).unwrap();
        black_box(posed.world_from(*tool).unwrap());
        posed.jacobian_into(*tool, Axes::World, jacobian).unwrap();
    });
}

#[divan::bench(sample_count = 500, sample_size = 100)]
fn fk_gravity(bencher: Bencher) {
    bench(bencher, |Bench { model, data, tool, q, gravity, .. }| {
        let mut posed = data.pose(model, q).unwrap();
        black_box(posed.world_from(*tool).unwrap());
        posed.gravity_into(gravity).unwrap();
    });
}

#[divan::bench(sample_count = 500, sample_size = 100)]
fn fk_jacobian_gravity(bencher: Bencher) {
    bench(bencher, |Bench { model, data, tool, q, jacobian, gravity }| {
        let mut posed = data.pose(model, q).unwrap();
        black_box(posed.world_from(*tool).unwrap());
        posed.jacobian_into(*tool, Axes::World, jacobian).unwrap();
        posed.gravity_into(gravity).unwrap();
    });
}

/// The kinematics of a tick of the controller: tool, Jacobian and places of the bodies.
#[divan::bench(sample_count = 500, sample_size = 100)]
fn kinematics_of_a_tick(bencher: Bencher) {
    let bodies = moca_safety().bodies;
    let mut robot = Kinematics::new(moca().unwrap(), MOCA_TOOL, &bodies, &MOCA_HOME).unwrap();
    let q = MOCA_HOME.map(|position| position + 0.1);
    bencher.bench_local(move || robot.update(black_box(&q)).unwrap());
}
