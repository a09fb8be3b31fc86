//! The last digits of an interior-point solution: with its active rows held, the optimum is a
//! linear least-squares problem.

use faer::{Col, ColRef};

use super::level::{LevelOptimum, LevelProgram};
use super::row_space::{RowSpace, row_norms, select_rows};

/// What may count as zero in an interior-point solution, relative \[-\]: tried in this order.
const GUESSES: [f64; 4] = [0.0, 1e-9, 1e-7, 1e-5];
/// How well the inequalities must hold at the polished point, relative \[-\].
const HOLDS: f64 = 1e-11;
/// What may be left of the gradient, and of a multiplier's wrong sign, at an optimum, relative to
/// the level's forces \[-\].
const BALANCED: f64 = 1e-9;

/// The optimum with more digits, and whether it is proved to be one.
pub(super) fn polish(program: &LevelProgram<'_>, rough: LevelOptimum) -> (LevelOptimum, bool) {
    let start = program.coordinates(rough.x.as_ref());
    let violations = program.violations(start.as_ref());
    let size = 1.0 + violations.norm_max();
    let room = &program.h - &program.g * &start;
    let (mut best, mut least) = (start.clone(), program.value(start.as_ref()));
    for zero in GUESSES {
        for nearby in GUESSES {
            let active: Vec<usize> =
                (0..room.nrows()).filter(|&i| rough.active[i] || room[i] < nearby).collect();
            let violated: Vec<usize> = (0..violations.nrows())
                .filter(|&i| program.is_equality(i) || violations[i].abs() > zero * size)
                .collect();
            let Some(y) = equality_constrained(program, start.as_ref(), &active, &violated) else {
                continue;
            };
            let excess = &program.g * &y - &program.h;
            let limit = HOLDS * (1.0 + y.norm_max());
            // Written so that NaN fails.
            if !excess.iter().all(|&excess| excess <= limit) {
                continue;
            }
            if is_optimal(program, y.as_ref(), &active) {
                return (LevelOptimum { x: program.point(y.as_ref()), ..rough }, true);
            }
            if program.value(y.as_ref()) < least {
                least = program.value(y.as_ref());
                best = y;
            }
        }
    }
    (LevelOptimum { x: program.point(best.as_ref()), ..rough }, false)
}

/// Returns true if multipliers of the right sign on the active rows balance the gradient at y.
fn is_optimal(program: &LevelProgram<'_>, y: ColRef<'_, f64>, active: &[usize]) -> bool {
    let violations = program.violations(y);
    let gradient = program.b.transpose() * &violations + &program.linear;
    let sizes = row_norms(program.b.as_ref());
    let forces: f64 = sizes.iter().zip(violations.iter()).map(|(a, w)| a * w.abs()).sum();
    let least =
        BALANCED * (forces + program.linear.norm_l2()) + program.rounding * program.b.norm_l2();
    let normals = select_rows(program.g.as_ref(), active);
    let normals = normals.transpose();
    let Some(space) = RowSpace::new(normals, &vec![1.0; normals.nrows()]) else { return false };
    let multipliers = space.minimise((-&gradient).as_ref(), Col::zeros(active.len()).as_ref());
    multipliers.iter().all(|&multiplier| multiplier >= -least)
        && (normals * multipliers + gradient).norm_l2() <= least
}

/// From `start` onto the active rows, then to the minimum of the violated rows' violation inside
/// them, by the shortest steps.
fn equality_constrained(
    program: &LevelProgram<'_>,
    start: ColRef<'_, f64>,
    active: &[usize],
    violated: &[usize],
) -> Option<Col<f64>> {
    let held = select_rows(program.g.as_ref(), active);
    let gap = Col::from_fn(active.len(), |i| program.h[active[i]]) - &held * start;
    let held = RowSpace::new(held.as_ref(), &row_norms(held.as_ref()))?;
    let onto = start + held.minimise(gap.as_ref(), Col::zeros(start.nrows()).as_ref());

    let b = select_rows(program.b.as_ref(), violated);
    let values = &b * start;
    let target = Col::from_fn(violated.len(), |i| {
        let (lower, upper) = (program.lower[violated[i]], program.upper[violated[i]]);
        if values[i] < lower { lower } else { upper }
    });
    let inside = &b * &held.nullspace;
    let linear = held.nullspace.transpose() * &program.linear;
    let step = RowSpace::new(inside.as_ref(), &row_norms(b.as_ref()))?
        .minimise((target - &b * &onto).as_ref(), linear.as_ref());
    Some(onto + &held.nullspace * step)
}
