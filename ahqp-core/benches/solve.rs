//! Solve times on generated problems: `cargo bench -p ahqp-core`.
//!
//! Each iteration updates the data and solves the next problem of a smooth sequence. It starts
//! either from the active set of the problem before (warm) or from an empty one (cold). The script
//! in `benches/peers` gives the same problems to other solvers.
#![allow(clippy::unwrap_used, missing_docs)]

use std::fmt::{self, Display};

use ahqp_core::testing::problems::{controller_sequence, growing_sequence, humanoid_sequence};
use ahqp_core::{Hierarchy, Settings, Solver, WarmStart};
use divan::{Bencher, black_box};

fn main() {
    divan::main();
}

/// A case of the benchmark: a size and the start of a solve.
#[derive(Clone, Copy)]
struct Case {
    size: usize,
    warm_start: WarmStart,
}

impl Display for Case {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let start = match self.warm_start {
            WarmStart::Cold => "cold",
            WarmStart::PreviousActiveSet => "warm",
        };
        write!(formatter, "{:3} {start}", self.size)
    }
}

fn cases(sizes: &'static [usize]) -> impl Iterator<Item = Case> {
    let starts = [WarmStart::PreviousActiveSet, WarmStart::Cold];
    starts
        .into_iter()
        .flat_map(|warm_start| sizes.iter().map(move |&size| Case { size, warm_start }))
}

/// The stack of a mobile manipulator at 1 kHz: 22 variables, 4 levels.
#[divan::bench(args = cases(&[22]), sample_count = 2000, sample_size = 1)]
fn controller(bencher: Bencher, case: Case) {
    run(bencher, case, &controller_sequence(1, 2000).unwrap());
}

/// A humanoid's size: 38 variables, 60 inequalities, 5 levels.
#[divan::bench(args = cases(&[38]), sample_count = 900, sample_size = 1)]
fn humanoid(bencher: Bencher, case: Case) {
    run(bencher, case, &humanoid_sequence(1, 300).unwrap());
}

/// An increasing number of variables in three levels.
#[divan::bench(args = cases(&[10, 20, 40, 80, 160, 320]), sample_size = 1)]
fn variables(bencher: Bencher, case: Case) {
    let n = case.size;
    let ticks = if n > 80 { 6 } else { 20 };
    run(bencher, case, &growing_sequence(1, n, &[n / 3, n / 3, n / 2], ticks).unwrap());
}

/// 40 variables and 48 rows in an increasing number of levels.
#[divan::bench(args = cases(&[2, 4, 8]), sample_size = 1)]
fn levels(bencher: Bencher, case: Case) {
    let rows = vec![48 / case.size; case.size];
    run(bencher, case, &growing_sequence(1, 40, &rows, 20).unwrap());
}

fn run(bencher: Bencher, case: Case, problems: &[Hierarchy]) {
    let settings = Settings { warm_start: case.warm_start, ..Settings::default() };
    let mut solver = Solver::new(&problems[0], settings).unwrap();
    let mut next = problems.iter().cycle();
    bencher.bench_local(|| {
        let problem = next.next().unwrap_or(&problems[0]);
        solver.solve(black_box(problem)).map(|solution| solution.optimum().unwrap()[0]).unwrap()
    });
}
