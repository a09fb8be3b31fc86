//! The last digits of an interior-point solution: with its active rows held, the optimum is a
//! linear least-squares problem.

use nalgebra::{DMatrix, DVector};

use super::interior::{Optimum, QuadraticProblem};
use super::span::{complement, least_squares};

/// How near the polished violations must be to the rough ones, relative \[-\].
const SAME: f64 = 1e-6;
/// How well the held inequalities must hold at the polished point \[-\].
const HOLDS: f64 = 1e-11;

/// The optimum with more digits, or nothing if the active rows of `rough` do not give it.
pub(super) fn polish(problem: &QuadraticProblem<'_>, rough: &Optimum) -> Option<Optimum> {
    let k = problem.basis.ncols();
    let start = problem.basis.tr_mul(&(&rough.x - problem.origin));
    let violations = problem.violations(&start);
    let size = 1.0 + violations.amax();
    let pulled: Vec<usize> = (0..violations.len())
        .filter(|&i| {
            problem.lower[i] == problem.upper[i] || violations[i].abs() > 1e-8 * size
        })
        .collect();
    let active: Vec<usize> = (0..rough.active.len()).filter(|&i| rough.active[i]).collect();

    // Onto the active rows, then to the minimum inside them.
    let held = problem.g.select_rows(&active);
    let onto = least_squares(&held, &select(&problem.h, &active), &DVector::zeros(k))?;
    let rows: Vec<_> = held.row_iter().map(|row| row.transpose()).collect();
    let inside = complement(&DMatrix::identity(k, k), &rows);
    let b = problem.b.select_rows(&pulled);
    let target = DVector::from_iterator(
        pulled.len(),
        pulled.iter().map(|&i| {
            if violations[i] < 0.0 { problem.lower[i] } else { problem.upper[i] }
        }),
    );
    let step = least_squares(
        &(&b * &inside),
        &(target - &b * &onto),
        &inside.tr_mul(&problem.linear),
    )?;
    let y = onto + inside * step;

    let holds = (&problem.g * &y - &problem.h).max() <= HOLDS * (1.0 + y.amax());
    let same = (problem.violations(&y) - violations).amax() <= SAME * size;
    (holds || problem.h.is_empty()).then_some(()).filter(|()| same)?;
    Some(Optimum {
        x: problem.origin + problem.basis * y,
        needed: rough.needed.clone(),
        active: rough.active.clone(),
    })
}

impl QuadraticProblem<'_> {
    /// B y minus the nearest point of its range, row by row.
    fn violations(&self, y: &DVector<f64>) -> DVector<f64> {
        let mut values = &self.b * y;
        for (i, value) in values.iter_mut().enumerate() {
            *value -= value.clamp(self.lower[i], self.upper[i]);
        }
        values
    }
}

fn select(values: &DVector<f64>, indices: &[usize]) -> DVector<f64> {
    DVector::from_iterator(indices.len(), indices.iter().map(|&i| values[i]))
}
