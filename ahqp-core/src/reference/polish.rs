//! Refinement of an interior-point solution. If its active rows are held, the optimum is a linear
//! least-squares problem.

use nalgebra::DVector;

use super::level::{LevelOptimum, LevelProgram};
use super::row_space::{RowSpace, row_norms, select_rows};

/// Thresholds for zero in an interior-point solution, relative \[-\], tried in this order.
const GUESSES: [f64; 4] = [0.0, 1e-9, 1e-7, 1e-5];
/// Accuracy to which the inequalities must hold at the polished point, relative \[-\].
const HOLDS: f64 = 1e-11;
/// Largest remainder of the gradient, and of a multiplier's wrong sign, at an optimum, relative to
/// the level's forces \[-\].
const BALANCED: f64 = 1e-9;

/// Returns the optimum with more digits, and whether it is proved to be one.
pub(super) fn polish(program: &LevelProgram<'_>, rough: LevelOptimum) -> (LevelOptimum, bool) {
    let start = program.coordinates(&rough.x);
    let violations = program.violations(&start);
    let size = 1.0 + violations.amax();
    let room = &program.h - &program.g * &start;
    let (mut best, mut least) = (start.clone(), program.value(&start));
    for zero in GUESSES {
        for nearby in GUESSES {
            let active: Vec<usize> =
                (0..room.nrows()).filter(|&i| rough.active[i] || room[i] < nearby).collect();
            let violated: Vec<usize> = (0..violations.nrows())
                .filter(|&i| program.is_equality(i) || violations[i].abs() > zero * size)
                .collect();
            let Some(y) = equality_constrained(program, &start, &active, &violated) else {
                continue;
            };
            let excess = &program.g * &y - &program.h;
            let limit = HOLDS * (1.0 + y.amax());
            // This form is false for NaN.
            if !excess.iter().all(|&excess| excess <= limit) {
                continue;
            }
            if is_optimal(program, &y, &active) {
                return (LevelOptimum { x: program.point(&y), ..rough }, true);
            }
            if program.value(&y) < least {
                least = program.value(&y);
                best = y;
            }
        }
    }
    (LevelOptimum { x: program.point(&best), ..rough }, false)
}

/// Returns true if multipliers of the right signs on the active rows balance the gradient at y.
fn is_optimal(program: &LevelProgram<'_>, y: &DVector<f64>, active: &[usize]) -> bool {
    let violations = program.violations(y);
    let gradient = program.b.transpose() * &violations + &program.linear;
    let sizes = row_norms(&program.b);
    let forces: f64 = sizes.iter().zip(violations.iter()).map(|(a, w)| a * w.abs()).sum();
    let least = BALANCED * (forces + program.linear.norm()) + program.rounding * program.b.norm();
    let normals = select_rows(&program.g, active);
    let normals = normals.transpose();
    let Some(space) = RowSpace::new(&normals, &vec![1.0; normals.nrows()]) else { return false };
    let multipliers = space.minimise(&-&gradient, &DVector::zeros(active.len()));
    multipliers.iter().all(|&multiplier| multiplier >= -least)
        && (&normals * multipliers + gradient).norm() <= least
}

/// Moves from `start` onto the active rows by the shortest step. From there moves, by the shortest
/// step within the active rows, to the minimum of the violation of the violated rows.
fn equality_constrained(
    program: &LevelProgram<'_>,
    start: &DVector<f64>,
    active: &[usize],
    violated: &[usize],
) -> Option<DVector<f64>> {
    let held = select_rows(&program.g, active);
    let gap = DVector::from_fn(active.len(), |i, _| program.h[active[i]]) - &held * start;
    let held = RowSpace::new(&held, &row_norms(&held))?;
    let onto = start + held.minimise(&gap, &DVector::zeros(start.nrows()));

    let b = select_rows(&program.b, violated);
    let values = &b * start;
    let target = DVector::from_fn(violated.len(), |i, _| {
        let (lower, upper) = (program.lower[violated[i]], program.upper[violated[i]]);
        if values[i] < lower { lower } else { upper }
    });
    let inside = &b * &held.nullspace;
    let linear = held.nullspace.transpose() * &program.linear;
    let step = RowSpace::new(&inside, &row_norms(&b))?.minimise(&(target - &b * &onto), &linear);
    Some(onto + &held.nullspace * step)
}
