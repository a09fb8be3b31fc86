//! The exact optimum of a hierarchy, in rational arithmetic.
//!
//! Shares nothing with the solver: no code, no rounding, no tolerance. A guess at the optimum only
//! says which active sets to try first; an active set is accepted when the conditions of Karush, Kuhn
//! and Tucker hold exactly.
#![allow(clippy::needless_range_loop)] // rows and columns of the same index

// By paths, as the fuzz targets read this file too.
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

/// The exact value of a double.
pub(crate) fn exact(value: f64) -> Exact {
    BigRational::from_float(value).unwrap()
}

/// The nearest double, near enough to compare with a tolerance.
pub(crate) fn double(value: &Exact) -> f64 {
    value.to_f64().unwrap()
}

/// The optimum of least norm, of n entries; none where the hard rows of a level cannot hold. `guess` is
/// where it is searched for first.
pub(crate) fn solve_exactly(hierarchy: &Hierarchy, guess: &[f64]) -> Option<Vec<Exact>> {
    solve_by(hierarchy, guess, |minimum, held, start, guess| {
        Some(minimise(minimum, held, start, guess))
    })
}

/// The same by trying all active sets: for few variables and rows, all of them bounded.
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

/// What x must keep: a x = b and a x ≤ b.
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

    /// Keeps what `x`, an optimum of `minimum`, has reached.
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
