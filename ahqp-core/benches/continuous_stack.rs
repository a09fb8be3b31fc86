//! Time of a tick of a continuous stack: `cargo bench -p ahqp-core --bench continuous_stack`.
//!
//! The problems are the controller's, with a warm start. The argument is the number of half-active
//! levels, each of which requires one more solution. `plain` is the same without a stack. Rewriting
//! the data is included.
#![allow(clippy::unwrap_used, missing_docs)]

use ahqp_core::testing::problems::controller_sequence;
use ahqp_core::{ContinuousStack, Hierarchy, Level, Settings, Solver};
use divan::{Bencher, black_box};

fn main() {
    divan::main();
}

fn problems() -> Vec<Hierarchy> {
    controller_sequence(1, 2000).unwrap()
}

#[divan::bench(sample_count = 2000, sample_size = 1)]
fn plain(bencher: Bencher) {
    let problems = problems();
    let mut hierarchy = problems[0].clone();
    let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
    let mut next = problems.iter().cycle();
    bencher.bench_local(|| {
        let problem = black_box(next.next().unwrap_or(&problems[0]));
        for (id, from) in hierarchy.ids().zip(problem.levels()) {
            copy_level(from, hierarchy.level_mut(id).unwrap());
        }
        let (lower, upper) = hierarchy.bounds_mut();
        lower.copy_from_slice(problem.lower());
        upper.copy_from_slice(problem.upper());
        solver.solve(&hierarchy).unwrap().optimum().unwrap()[0]
    });
}

#[divan::bench(args = [0, 1, 2], sample_count = 2000, sample_size = 1)]
fn stack(bencher: Bencher, changes: usize) {
    let problems = problems();
    let mut stack = ContinuousStack::new(&problems[0], Settings::default()).unwrap();
    let levels: Vec<_> = stack.ids().collect();
    for (i, level) in levels.iter().rev().take(changes).enumerate() {
        stack.activate(*level, 0.5 + 0.1 * i as f64, 0.0).unwrap();
    }
    let mut next = problems.iter().cycle();
    bencher.bench_local(|| {
        let problem = black_box(next.next().unwrap_or(&problems[0]));
        for (id, from) in levels.iter().zip(problem.levels()) {
            copy_level(from, stack.level_mut(*id).unwrap());
        }
        let (lower, upper) = stack.bounds_mut();
        lower.copy_from_slice(problem.lower());
        upper.copy_from_slice(problem.upper());
        stack.solve(1e-3).unwrap().best()[0]
    });
}

fn copy_level(from: &Level, to: &mut Level) {
    to.constraints_mut().copy_from(from.constraints()).unwrap();
    match from.objective() {
        ahqp_core::Objective::LeastSquares(rows) => {
            to.rows_mut().unwrap().copy_from(rows).unwrap();
        }
        ahqp_core::Objective::Quadratic { hessian, gradient } => {
            let (to_hessian, to_gradient) = to.quadratic_mut().unwrap();
            to_hessian.copy_from(hessian);
            to_gradient.copy_from(gradient);
        }
        _ => {}
    }
}
