//! Feasibility of inequalities, in rational arithmetic.
//!
//! It shares nothing with the solver. It uses the first phase of the simplex method (Dantzig) by
//! least index, which cannot cycle (Bland, Mathematics of Operations Research 2, 1977). Its verdict
//! is proved by a point, or by multipliers with which the sum of the rows is a contradiction
//! (Farkas).

use num_traits::{One, Signed, Zero};

use crate::exact::{Exact, exact};

/// Verdict with its proof.
pub(super) enum Verdict {
    /// All inequalities hold at this point.
    Point(Vec<Exact>),
    /// Multipliers y ≥ 0 with Σ yᵢ aᵢ = 0 and Σ yᵢ bᵢ < 0.
    Contradiction(Vec<Exact>),
}

/// Decides whether all a x ≤ b can hold together for some free x.
pub(super) fn feasibility(inequalities: &[(Vec<f64>, f64)]) -> Verdict {
    let verdict = Tableau::new(inequalities).minimise();
    expect_proof(inequalities, &verdict);
    verdict
}

fn expect_proof(inequalities: &[(Vec<f64>, f64)], verdict: &Verdict) {
    let sum = |terms: &mut dyn Iterator<Item = Exact>| terms.sum::<Exact>();
    match verdict {
        Verdict::Point(x) => {
            for (a, b) in inequalities {
                let value = sum(&mut a.iter().zip(x).map(|(&a, x)| exact(a) * x));
                assert!(value <= exact(*b), "the point holds");
            }
        }
        Verdict::Contradiction(y) => {
            assert!(y.iter().all(|y| !y.is_negative()), "multipliers are not negative");
            let columns = inequalities.first().map_or(0, |(a, _)| a.len());
            for j in 0..columns {
                let entry = sum(&mut inequalities.iter().zip(y).map(|((a, _), y)| exact(a[j]) * y));
                assert!(entry.is_zero(), "the sum of the rows is zero");
            }
            let bound = sum(&mut inequalities.iter().zip(y).map(|((_, b), y)| exact(*b) * y));
            assert!(bound.is_negative(), "the sum of the bounds is negative");
        }
    }
}

/// The tableau [A −A I artificial | b] and the reduced costs of the sum of the artificial
/// variables. Rows with b < 0 are multiplied by −1.
struct Tableau {
    rows: Vec<Vec<Exact>>,
    costs: Vec<Exact>,
    /// Column that each row determines.
    basis: Vec<usize>,
    variables: usize,
    /// Columns that may enter: all except the artificial ones.
    columns: usize,
}

impl Tableau {
    fn new(inequalities: &[(Vec<f64>, f64)]) -> Self {
        let (m, n) = (inequalities.len(), inequalities.first().map_or(0, |(a, _)| a.len()));
        let columns = 2 * n + m;
        let negative: Vec<usize> = (0..m).filter(|&i| inequalities[i].1 < 0.0).collect();
        let mut rows = vec![vec![Exact::zero(); columns + 1]; m];
        let mut basis = Vec::with_capacity(m);
        for (i, (a, b)) in inequalities.iter().enumerate() {
            let sign = if *b < 0.0 { -1.0 } else { 1.0 };
            for (j, &a) in a.iter().enumerate() {
                (rows[i][j], rows[i][n + j]) = (exact(sign * a), exact(-sign * a));
            }
            (rows[i][2 * n + i], rows[i][columns]) = (exact(sign), exact(sign * b));
            // An artificial variable never re-enters, so its column is not stored.
            basis.push(if *b < 0.0 { columns + i } else { 2 * n + i });
        }
        let mut costs = vec![Exact::zero(); columns + 1];
        for &i in &negative {
            for (cost, entry) in costs.iter_mut().zip(&rows[i]) {
                *cost -= entry;
            }
        }
        Self { rows, costs, basis, variables: n, columns }
    }

    /// Minimises the sum of the artificial variables.
    fn minimise(mut self) -> Verdict {
        while let Some(column) = self.costs[..self.columns].iter().position(Signed::is_negative) {
            // The sum is not negative, so some row blocks.
            let row = (0..self.rows.len())
                .filter(|&i| self.rows[i][column].is_positive())
                .min_by_key(|&i| {
                    (&self.rows[i][self.columns] / &self.rows[i][column], self.basis[i])
                })
                .expect("a row in the way");
            self.pivot(row, column);
        }
        let n = self.variables;
        // The last cost is the negative sum.
        if self.costs[self.columns].is_zero() {
            let mut x = vec![Exact::zero(); n];
            for (row, &column) in self.rows.iter().zip(&self.basis) {
                if column < n {
                    x[column] += &row[self.columns];
                } else if column < 2 * n {
                    x[column - n] -= &row[self.columns];
                }
            }
            Verdict::Point(x)
        } else {
            Verdict::Contradiction(self.costs[2 * n..self.columns].to_vec())
        }
    }

    fn pivot(&mut self, row: usize, column: usize) {
        let inverse = Exact::one() / &self.rows[row][column];
        for entry in &mut self.rows[row] {
            *entry *= &inverse;
        }
        let pivot = self.rows[row].clone();
        let others = self.rows.iter_mut().enumerate().filter(|(i, _)| *i != row);
        for other in others.map(|(_, other)| other).chain([&mut self.costs]) {
            let factor = other[column].clone();
            if !factor.is_zero() {
                for (entry, pivot) in other.iter_mut().zip(&pivot) {
                    *entry -= &factor * pivot;
                }
            }
        }
        self.basis[row] = column;
    }
}
