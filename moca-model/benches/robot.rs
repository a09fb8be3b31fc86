//! Time of one call for MOCA, n = 10.
#![allow(clippy::unwrap_used, missing_docs)]

use divan::{Bencher, black_box};
use moca_model::{MOCA_HOME, RobotData, RobotModel, forward_kinematics, gravity, jacobian};

fn main() {
    divan::main();
}

fn bench(bencher: Bencher, mut call: impl FnMut(&RobotModel, &mut RobotData, &[f64])) {
    let model = RobotModel::moca().unwrap();
    let mut data = RobotData::new(&model);
    let q = MOCA_HOME.map(|position| position + 0.1);
    bencher.bench_local(move || {
        call(black_box(&model), &mut data, black_box(&q));
        black_box(&mut data);
    });
}

#[divan::bench(sample_count = 500, sample_size = 100)]
fn fk(bencher: Bencher) {
    bench(bencher, |model, data, q| forward_kinematics(model, data, q).unwrap());
}

#[divan::bench(sample_count = 500, sample_size = 100)]
fn fk_jacobian(bencher: Bencher) {
    bench(bencher, |model, data, q| {
        forward_kinematics(model, data, q).unwrap();
        jacobian(model, data).unwrap();
    });
}

#[divan::bench(sample_count = 500, sample_size = 100)]
fn fk_gravity(bencher: Bencher) {
    bench(bencher, |model, data, q| {
        forward_kinematics(model, data, q).unwrap();
        gravity(model, data).unwrap();
    });
}

#[divan::bench(sample_count = 500, sample_size = 100)]
fn fk_jacobian_gravity(bencher: Bencher) {
    bench(bencher, |model, data, q| {
        forward_kinematics(model, data, q).unwrap();
        jacobian(model, data).unwrap();
        gravity(model, data).unwrap();
    });
}
