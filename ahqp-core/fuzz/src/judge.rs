//! Judgement of answers.

use ahqp_core::{Error, Hierarchy, Solver, Status};

use crate::exact::{double, solve_exactly};

/// An optimum counts as undetermined if a change of the data by 1e-15 moves it by more than this.
const SENSITIVE: f64 = 1e-7;

/// Solves a hierarchy with all solvers, and compares the solutions with the exact optimum. The
/// certificate must reject every wrong answer.
///
/// # Panics
/// If an answer is wrong and its certificate accepts it.
pub fn expect_right(solvers: &mut [Solver], hierarchy: &Hierarchy) {
    let mut exact: Option<Option<Vec<f64>>> = None;
    for solver in solvers {
        let x = match solver.solve(hierarchy) {
            Ok(solution) => {
                assert_eq!(solution.status(), Status::Solved, "{hierarchy:?}");
                Some(solution.best().to_vec())
            }
            Err(Error::Inaccurate { .. }) => continue,
            Err(Error::Infeasible { .. }) => None,
            Err(error) => panic!("{error}: {hierarchy:?}"),
        };
        let guess = || x.clone().unwrap_or_else(|| vec![0.0; hierarchy.variables()]);
        match (&x, exact.get_or_insert_with(|| optimum(hierarchy, &guess()))) {
            (Some(x), Some(exact)) => expect_right_or_doubted(solver, hierarchy, x, exact),
            (None, None) => {}
            (x, exact) => panic!("{x:?} instead of {exact:?}: {hierarchy:?}"),
        }
    }
}

fn expect_right_or_doubted(solver: &mut Solver, hierarchy: &Hierarchy, x: &[f64], exact: &[f64]) {
    if distance(x, exact) <= 1e-6 {
        return;
    }
    let sensitivity = (1..4)
        .map(|pattern| optimum(&perturbed(hierarchy, pattern), exact))
        .map(|moved| moved.map_or(f64::INFINITY, |moved| distance(&moved, exact)))
        .fold(0.0, f64::max);
    let certificate = solver.certificate(hierarchy).expect("a certificate of what was solved");
    let worst = certificate.residuals(hierarchy, x).expect("the same hierarchy").worst();
    assert!(
        sensitivity > SENSITIVE || worst > 1e-8,
        "{x:?} instead of {exact:?}, certificate {worst:e}: {hierarchy:?}"
    );
}

fn optimum(hierarchy: &Hierarchy, guess: &[f64]) -> Option<Vec<f64>> {
    Some(solve_exactly(hierarchy, guess)?.iter().map(double).collect())
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs() / (1.0 + b.abs())).fold(0.0, f64::max)
}

/// Returns the hierarchy with every coefficient changed by 1e-15 of it, up or down.
fn perturbed(hierarchy: &Hierarchy, pattern: u32) -> Hierarchy {
    let mut other = hierarchy.clone();
    let mut state = pattern;
    let mut nudge = |value: &mut f64| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        *value *= if state >> 31 == 0 { 1.0 + 1e-15 } else { 1.0 - 1e-15 };
    };
    for id in hierarchy.ids() {
        let level = other.level_mut(id).expect("a level");
        let constraints = level.constraints_mut();
        for i in 0..constraints.len() {
            constraints.row_mut(i).expect("a row").iter_mut().for_each(&mut nudge);
        }
        if let Ok(rows) = level.rows_mut() {
            for i in 0..rows.len() {
                rows.row_mut(i).expect("a row").iter_mut().for_each(&mut nudge);
            }
        }
    }
    other
}
