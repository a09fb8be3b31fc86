//! The last digits of an interior-point solution: with its active rows held, the optimum is a
//! linear least-squares problem.

use nalgebra::{DMatrix, DVector};

use super::interior::{Optimum, QuadraticProblem};
use super::span::{complement, least_squares};

/// What may count as zero in an interior-point solution, relative \[-\]: tried in this order.
const GUESSES: [f64; 4] = [0.0, 1e-9, 1e-7, 1e-5];
/// How well the held inequalities must hold at the polished point, relative \[-\].
const HOLDS: f64 = 1e-11;
/// What may be left of the gradient, and of a multiplier's wrong sign, at an optimum, relative to
/// the level's forces \[-\].
const BALANCED: f64 = 1e-9;

/// The optimum with more digits, and whether it is proved to be one.
pub(super) fn polish(problem: &QuadraticProblem<'_>, rough: Optimum) -> (Optimum, bool) {
    let start = problem.coordinates(&rough.x);
    let violations = problem.violations(&start);
    let size = 1.0 + violations.amax();
    let (mut best, mut least) = (start.clone(), problem.value(&start));
    for zero in GUESSES {
        for nearby in GUESSES {
            let near = (&problem.h - &problem.g * &start).map(|room| room < nearby);
            let active: Vec<usize> =
                (0..near.len()).filter(|&i| rough.active[i] || near[i]).collect();
            let pulled: Vec<usize> = (0..violations.len())
                .filter(|&i| problem.is_equality(i) || violations[i].abs() > zero * size)
                .collect();
            let Some(y) = equality_constrained(problem, &start, &active, &pulled) else {
                continue;
            };
            let excess = &problem.g * &y - &problem.h;
            if excess.iter().any(|&excess| excess > HOLDS * (1.0 + y.amax())) {
                continue;
            }
            if is_optimal(problem, &y, &active) {
                return (Optimum { x: problem.point(&y), ..rough }, true);
            }
            if problem.value(&y) < least {
                least = problem.value(&y);
                best = y;
            }
        }
    }
    (Optimum { x: problem.point(&best), ..rough }, false)
}

/// Whether multipliers of the right sign on the active rows balance the gradient at y.
fn is_optimal(problem: &QuadraticProblem<'_>, y: &DVector<f64>, active: &[usize]) -> bool {
    let violations = problem.violations(y);
    let gradient = problem.b.tr_mul(&violations) + &problem.linear;
    let forces = norms(&problem.b).iter().zip(&violations).map(|(a, w)| a * w.abs()).sum::<f64>();
    let least = BALANCED * (forces + problem.linear.norm()) + problem.rounding * problem.b.norm();
    let transposed = problem.g.select_rows(active).transpose();
    let none = DVector::zeros(active.len());
    least_squares(&transposed, &vec![1.0; transposed.nrows()], &-&gradient, &none).is_some_and(
        |multipliers| {
            multipliers.iter().all(|&multiplier| multiplier >= -least)
                && (transposed * multipliers + gradient).norm() <= least
        },
    )
}

/// From `start` onto the active rows, then to the minimum of the pulled rows' violation inside
/// them, by the shortest steps.
fn equality_constrained(
    problem: &QuadraticProblem<'_>,
    start: &DVector<f64>,
    active: &[usize],
    pulled: &[usize],
) -> Option<DVector<f64>> {
    let k = problem.basis.ncols();
    let held = problem.g.select_rows(active);
    let gap = select(&problem.h, active) - &held * start;
    let onto = start + least_squares(&held, &norms(&held), &gap, &DVector::zeros(k))?;
    let rows: Vec<_> = held.row_iter().map(|row| row.transpose()).collect();
    let inside = complement(&DMatrix::identity(k, k), &rows);
    let b = problem.b.select_rows(pulled);
    let values = &problem.b * start;
    let bound = |&i: &usize| {
        let (lower, upper) = (problem.lower[i], problem.upper[i]);
        if values[i] < lower { lower } else { upper }
    };
    let target = DVector::from_iterator(pulled.len(), pulled.iter().map(bound));
    let linear = inside.tr_mul(&problem.linear);
    let step = least_squares(&(&b * &inside), &norms(&b), &(target - &b * &onto), &linear)?;
    Some(onto + inside * step)
}

fn select(values: &DVector<f64>, indices: &[usize]) -> DVector<f64> {
    DVector::from_iterator(indices.len(), indices.iter().map(|&i| values[i]))
}

fn norms(matrix: &DMatrix<f64>) -> Vec<f64> {
    matrix.row_iter().map(|row| row.norm()).collect()
}
