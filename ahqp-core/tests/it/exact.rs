//! The exact optimum of a hierarchy, in rational arithmetic.
//!
//! It shares nothing with the solver: no code, no rounding, no tolerance. A guess at the optimum
//! only decides which active sets are tried first. An active set is accepted if the conditions of
//! Karush, Kuhn and Tucker hold exactly.
#![allow(clippy::needless_range_loop)] // rows and columns of the same index

// Paths are given, since the fuzz targets include this file too.
#[path = "exact/elimination.rs"]
mod elimination;
#[path = "exact/level.rs"]
mod level;

use ahqp_core::{Hierarchy, Objective, Rows};
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};

use level::{Linear, Minimum, enumerate, minimise};

/// An exact number.
pub(crate) type Exact = BigRational;

/// Returns the exact value of a double.
pub(crate) fn exact(value: f64) -> Exact {
    BigRational::from_float(value).unwrap()
}

/// Returns a double close enough for comparison with a tolerance.
pub(crate) fn double(value: &Exact) -> f64 {
    value.to_f64().unwrap()
}

/// Returns the optimum of least norm, of n entries. None if the hard rows of a level cannot hold.
/// The search starts at `guess`.
pub(crate) fn solve_exactly(hierarchy: &Hierarchy, guess: &[f64]) -> Option<Vec<Exact>> {
    solve_by(hierarchy, guess, |minimum, held, start, guess| {
        Some(minimise(minimum, held, start, guess))
    })
}

/// Returns the optimum by trying all active sets. This is for few variables and rows, with all
/// variables bounded.
pub(crate) fn enumerate_exactly(hierarchy: &Hierarchy, guess: &[f64]) -> Option<Vec<Exact>> {
    solve_by(hierarchy, guess, |minimum, held, _, guess| enumerate(minimum, held, guess))
}

fn solve_by(
    hierarchy: &Hierarchy,
    guess: &[f64],
    minimise: impl Fn(&Minimum, &Held, &[Exact], &[Exact]) -> Option<Vec<Exact>>,
) -> Option<Vec<Exact>> {
    let n = hierarchy.variables();
    let guess: Vec<Exact> = guess.iter().map(|&x| exact(x)).collect();
    let mut held = Held { equalities: Vec::new(), inequalities: Vec::new() };
    let mut x = Vec::with_capacity(n);
    for i in 0..n {
        let mut row = vec![0.0; n];
        row[i] = 1.0;
        let (lower, upper) = (hierarchy.lower()[i], hierarchy.upper()[i]);
        held.constrain(&row, lower, upper);
        x.push(exact(0.0_f64.clamp(lower, upper)));
    }
    for level in hierarchy.levels() {
        let mut feasible = Minimum::new(n);
        feasible.add_rows(level.constraints());
        x = minimise(&feasible, &held, &x, &guess)?;
        if feasible.equalities.iter().any(|row| !row.gap(&x).is_zero())
            || feasible.inequalities.iter().any(|row| row.gap(&x).is_positive())
        {
            return None;
        }
        for (row, lower, upper) in level.constraints().iter() {
            held.constrain(row, lower, upper);
        }
        let mut objective = Minimum::new(n);
        match level.objective() {
            Objective::LeastSquares(rows) => objective.add_rows(rows),
            Objective::Quadratic { hessian, gradient } => {
                for i in 0..n {
                    for j in 0..n {
                        objective.hessian[i][j] += exact(hessian[(i, j)]);
                    }
                    objective.gradient[i] += exact(gradient[i]);
                }
            }
            _ => {}
        }
        x = minimise(&objective, &held, &x, &guess)?;
        held.fix(&objective, &x);
    }
    let mut norm = Minimum::new(n);
    for i in 0..n {
        norm.hessian[i][i] = exact(1.0);
    }
    minimise(&norm, &held, &x, &guess)
}

/// Conditions that x must keep: a x = b and a x ≤ b.
#[derive(Debug, Clone)]
pub(crate) struct Held {
    equalities: Vec<Linear>,
    inequalities: Vec<Linear>,
}

impl Held {
    fn constrain(&mut self, row: &[f64], lower: f64, upper: f64) {
        if lower == upper {
            self.equalities.push(Linear::new(row, upper, 1.0));
            return;
        }
        if upper.is_finite() {
            self.inequalities.push(Linear::new(row, upper, 1.0));
        }
        if lower.is_finite() {
            self.inequalities.push(Linear::new(row, lower, -1.0));
        }
    }

    /// Keeps the values that `x`, an optimum of `minimum`, has reached.
    fn fix(&mut self, minimum: &Minimum, x: &[Exact]) {
        let mut fix = |row: &[Exact]| {
            let value = row.iter().zip(x).map(|(a, x)| a * x).sum();
            self.equalities.push(Linear { a: row.to_vec(), b: value });
        };
        for row in &minimum.hessian {
            if row.iter().any(|entry| !entry.is_zero()) {
                fix(row);
            }
        }
        if minimum.gradient.iter().any(|entry| !entry.is_zero()) {
            fix(&minimum.gradient);
        }
        for soft in &minimum.equalities {
            fix(&soft.a);
        }
        for soft in &minimum.inequalities {
            if soft.gap(x) > Exact::zero() {
                fix(&soft.a);
            } else {
                self.inequalities.push(soft.clone());
            }
        }
    }
}

impl Minimum {
    fn add_rows(&mut self, rows: &Rows) {
        for (row, lower, upper) in rows.iter() {
            if lower == upper {
                self.equalities.push(Linear::new(row, upper, 1.0));
                continue;
            }
            if upper.is_finite() {
                self.inequalities.push(Linear::new(row, upper, 1.0));
            }
            if lower.is_finite() {
                self.inequalities.push(Linear::new(row, lower, -1.0));
            }
        }
    }
}
