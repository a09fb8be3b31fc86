//! Time of one `Ik::step` in motion with limits of position, velocity, acceleration and jerk. The robots are a Panda
//! with 3 levels, two arms on a base with 6, and a humanoid with 5 levels and 60 inequalities.
//!
//! Run `cargo bench -p whole-body --bench ik`. `--bench ik_percentiles` gives the slowest steps, and
//! `benches/peers/ik.py` measures Pink and mink.
#![allow(clippy::unwrap_used, missing_docs)]

#[path = "support/ik_loops.rs"]
mod ik_loops;

use divan::Bencher;
use ik_loops::{Loop, humanoid, panda, two_arms};

fn main() {
    divan::main();
}

fn bench(bencher: Bencher, mut robot: Loop) {
    (0..500).for_each(|_| robot.step());
    bencher.bench_local(move || robot.step());
}

#[divan::bench(sample_count = 20000, sample_size = 1)]
fn panda_3_levels(bencher: Bencher) {
    bench(bencher, panda());
}

#[divan::bench(sample_count = 20000, sample_size = 1)]
fn two_arms_6_levels(bencher: Bencher) {
    bench(bencher, two_arms());
}

#[divan::bench(sample_count = 20000, sample_size = 1)]
fn humanoid_5_levels_60_inequalities(bencher: Bencher) {
    bench(bencher, humanoid());
}
