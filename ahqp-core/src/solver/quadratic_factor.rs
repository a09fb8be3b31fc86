//! Quadratic objectives as least squares: H = RᵀR by pivoted Cholesky factorisation.

use nalgebra::{DMatrix, DVector};

use crate::error::Error;
use crate::linalg::list::List;
use crate::linalg::vector::dot;
use crate::problem::ids::LevelId;
use crate::problem::source::{ConstraintSource, Names};
use crate::solver::tolerances::ROUNDING;

/// Pivots below this fraction of their diagonal entry count as zero.
const RANK_TOLERANCE: f64 = 1e-12;
/// Diagonal entries below this fraction of the largest count as zero: curvatures of rows 1e8 apart
/// are 1e16 apart.
const SMALLEST_CURVATURE: f64 = 1e-18;
/// Above this, products of the solver's numbers overflow.
const MODERATE: f64 = 1e100;
/// Asymmetry and negative curvature up to this fraction of the largest entry are rounding.
const SHAPE_TOLERANCE: f64 = 1e-9;
/// Of the terms it is made of, less of a linear part is rounding.
const LINEAR_TOLERANCE: f64 = 1e-9;

/// ½xᵀHx + gᵀx = ½‖Rx − b‖² + linearᵀx + constant.
///
/// R has as many rows as H has rank. The linear part is what of the gradient lies outside the
/// range of H; it vanishes for objectives that are bounded below everywhere.
#[derive(Debug, Clone)]
pub(crate) struct QuadraticFactor {
    n: usize,
    rank: usize,
    /// R, row after row.
    factor: Vec<f64>,
    target: Vec<f64>,
    /// The rounding in the target, and of what size that in a row is relative to the row.
    target_rounding: Vec<f64>,
    amplification: Vec<f64>,
    pivots: List<usize>,
    /// What of the diagonal is not factored yet.
    diagonal: Vec<f64>,
    linear: Vec<f64>,
}

impl QuadraticFactor {
    pub(crate) fn new(n: usize) -> Self {
        Self {
            n,
            rank: 0,
            factor: vec![0.0; n * n],
            target: vec![0.0; n],
            target_rounding: vec![0.0; n],
            amplification: vec![1.0; n],
            pivots: List::with_capacity(n),
            diagonal: vec![0.0; n],
            linear: vec![0.0; n],
        }
    }

    pub(crate) fn rank(&self) -> usize {
        self.rank
    }

    pub(crate) fn row(&self, index: usize) -> (&[f64], f64) {
        (&self.factor[index * self.n..(index + 1) * self.n], self.target[index])
    }

    /// The rounding of a row's entries, relative to the row, in units of ordinary rounding, and that
    /// of its target: what a small pivot leaves of large terms.
    pub(crate) fn rounding(&self, index: usize) -> (f64, f64) {
        (self.amplification[index], self.target_rounding[index])
    }

    /// Copies the linear part; whether there is one.
    pub(crate) fn linear(&self, out: &mut [f64]) -> bool {
        out.copy_from_slice(&self.linear);
        self.linear.iter().any(|entry| *entry != 0.0)
    }

    /// Multipliers of rows of R as multipliers of rows of H: `(row of H, multiplier)`.
    pub(crate) fn to_hessian_rows(&self, multipliers: &[f64]) -> Vec<(usize, f64)> {
        let n = self.n;
        let mut z = multipliers.to_vec();
        // H at the pivots is (R at the pivots)ᵀ R, so μᵀR = (R at the pivots)⁻¹μ times it.
        for i in (0..self.rank.min(z.len())).rev() {
            let known: f64 =
                (i + 1..self.rank).map(|j| self.factor[i * n + self.pivots[j]] * z[j]).sum();
            z[i] = (z[i] - known) / self.factor[i * n + self.pivots[i]];
        }
        self.pivots.iter().copied().zip(z).collect()
    }

    /// Factors H (n × n) and splits g.
    pub(crate) fn factorise(
        &mut self,
        level: usize,
        hessian: &DMatrix<f64>,
        gradient: &DVector<f64>,
    ) -> Result<(), Error> {
        let n = self.n;
        if hessian.shape() != (n, n) || gradient.len() != n {
            return Err(Error::ShapeChanged {
                level: LevelId::new(level),
                names: Names::default(),
            });
        }
        check_finite(level, hessian, gradient)?;
        let scale = hessian.amax();
        check_moderate(level, scale.max(gradient.amax()))?;
        check_symmetric(level, hessian, scale)?;
        self.rank = 0;
        self.pivots.clear();
        for i in 0..n {
            self.diagonal[i] = hessian[(i, i)];
        }
        while self.rank < n {
            let Some(pivot) = self.best_pivot(hessian, scale) else { break };
            self.eliminate(hessian, pivot);
        }
        self.check_remainder(level, hessian, scale)?;
        self.split_gradient(gradient);
        Ok(())
    }

    /// The variable with the largest share of its curvature left, whatever its unit.
    fn best_pivot(&self, hessian: &DMatrix<f64>, scale: f64) -> Option<usize> {
        let share = |i: usize| self.diagonal[i] / hessian[(i, i)];
        (0..self.n)
            .filter(|&i| hessian[(i, i)] > SMALLEST_CURVATURE * scale && share(i) > RANK_TOLERANCE)
            .max_by(|&i, &j| share(i).total_cmp(&share(j)))
    }

    fn eliminate(&mut self, hessian: &DMatrix<f64>, pivot: usize) {
        let (n, rank) = (self.n, self.rank);
        let root = self.diagonal[pivot].sqrt();
        let (done, rest) = self.factor.split_at_mut(rank * n);
        let row = &mut rest[..n];
        for (j, entry) in row.iter_mut().enumerate() {
            *entry = hessian[(pivot, j)];
        }
        for above in done.chunks_exact(n) {
            crate::linalg::vector::add_scaled(row, -above[pivot], above);
        }
        for (j, entry) in row.iter_mut().enumerate() {
            *entry = if self.pivots.contains(&j) { 0.0 } else { *entry / root };
        }
        row[pivot] = root;
        self.amplification[rank] = hessian[(pivot, pivot)].sqrt() / root;
        for (left, entry) in self.diagonal.iter_mut().zip(row.iter()) {
            *left -= entry * entry;
        }
        self.diagonal[pivot] = f64::NEG_INFINITY;
        self.pivots.push(pivot);
        self.rank += 1;
    }

    /// What is left of a PSD matrix after its last positive pivot is zero.
    fn check_remainder(
        &self,
        level: usize,
        hessian: &DMatrix<f64>,
        scale: f64,
    ) -> Result<(), Error> {
        let n = self.n;
        for i in (0..n).filter(|i| !self.pivots.contains(i)) {
            for j in (0..=i).filter(|j| !self.pivots.contains(j)) {
                let product: f64 =
                    self.factor[..self.rank * n].chunks_exact(n).map(|row| row[i] * row[j]).sum();
                let remainder = hessian[(i, j)] - product;
                if remainder.abs() > SHAPE_TOLERANCE * scale {
                    return Err(Error::IndefiniteHessian {
                        level: LevelId::new(level),
                        variable: i,
                        pivot: remainder,
                        names: Names::default(),
                    });
                }
            }
        }
        Ok(())
    }

    /// b with (Rᵀb)ᵢ = −gᵢ at the pivots; the rest of g is linear.
    fn split_gradient(&mut self, gradient: &DVector<f64>) {
        let n = self.n;
        for (i, &pivot) in self.pivots.iter().enumerate() {
            let terms = (0..i).map(|above| self.factor[above * n + pivot] * self.target[above]);
            let (known, size) = terms.fold((0.0, gradient[pivot].abs()), |(sum, size), term| {
                (sum + term, size + term.abs())
            });
            let root = self.factor[i * n + pivot];
            self.target[i] = (-gradient[pivot] - known) / root;
            self.target_rounding[i] = ROUNDING * size / root;
        }
        for j in 0..n {
            let terms = (0..self.rank).map(|i| self.factor[i * n + j] * self.target[i]);
            let (range, size) = terms.fold((0.0, gradient[j].abs()), |(range, size), term| {
                (range + term, size + term.abs())
            });
            let rest: f64 = gradient[j] + range;
            let is_linear = !self.pivots.contains(&j) && rest.abs() > LINEAR_TOLERANCE * size;
            self.linear[j] = if is_linear { rest } else { 0.0 };
        }
    }
}

fn check_finite(
    level: usize,
    hessian: &DMatrix<f64>,
    gradient: &DVector<f64>,
) -> Result<(), Error> {
    let find = |values: &[f64]| values.iter().position(|v| !v.is_finite());
    let not_finite = |what, row, entry| Error::NotFinite {
        what,
        source_of_row: ConstraintSource::Objective { level: LevelId::new(level), row },
        entry,
        names: Names::default(),
    };
    if !dot(hessian.as_slice(), hessian.as_slice()).is_finite()
        && let Some(entry) = find(hessian.as_slice())
    {
        let rows = hessian.nrows().max(1);
        let (row, entry) = (entry % rows, entry / rows);
        return Err(not_finite("the Hessian", row, entry));
    }
    if let Some(entry) = find(gradient.as_slice()) {
        return Err(not_finite("the gradient", entry, entry));
    }
    Ok(())
}

fn check_moderate(level: usize, value: f64) -> Result<(), Error> {
    if value <= MODERATE {
        return Ok(());
    }
    let source_of_row = ConstraintSource::Objective { level: LevelId::new(level), row: 0 };
    Err(Error::TooLarge { source_of_row, value, names: Names::default() })
}

fn check_symmetric(level: usize, hessian: &DMatrix<f64>, scale: f64) -> Result<(), Error> {
    for row in 0..hessian.nrows() {
        for column in 0..row {
            let difference = (hessian[(row, column)] - hessian[(column, row)]).abs();
            if difference > SHAPE_TOLERANCE * scale {
                let (level, names) = (LevelId::new(level), Names::default());
                return Err(Error::AsymmetricHessian { level, row, column, difference, names });
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_least_squares_form_is_the_quadratic(
            entries in prop::collection::vec(-2.0_f64..2.0, 3 * 5),
            gradient in prop::collection::vec(-2.0_f64..2.0, 5),
            points in prop::collection::vec(-2.0_f64..2.0, 2 * 5),
        ) {
            let half = DMatrix::from_row_slice(3, 5, &entries);
            let hessian = half.transpose() * &half;
            let gradient = DVector::from_vec(gradient);
            let mut factor = QuadraticFactor::new(5);
            factor.factorise(0, &hessian, &gradient).unwrap();
            let mut linear = vec![0.0; 5];
            factor.linear(&mut linear);
            let value = |x: &[f64]| {
                let squares: f64 = (0..factor.rank())
                    .map(|i| { let (row, target) = factor.row(i); (dot(row, x) - target).powi(2) })
                    .sum();
                0.5 * squares + dot(&linear, x)
            };
            let quadratic = |x: &[f64]| {
                let x = DVector::from_row_slice(x);
                0.5 * (x.transpose() * &hessian * &x)[0] + gradient.dot(&x)
            };
            let (x, y) = points.split_at(5);
            let (left, right) = (value(x) - value(y), quadratic(x) - quadratic(y));
            prop_assert!((left - right).abs() < 1e-6 * (1.0 + right.abs()));
        }
    }

    #[test]
    fn an_indefinite_hessian_is_refused() {
        let gradient = DVector::zeros(2);
        let mut factor = QuadraticFactor::new(2);
        for entries in [[1.0, 0.0, 0.0, -1.0], [0.0, 1.0, 1.0, 0.0], [1.0, 2.0, 2.0, 1.0]] {
            let hessian = DMatrix::from_row_slice(2, 2, &entries);
            let error = factor.factorise(3, &hessian, &gradient).unwrap_err();
            let Error::IndefiniteHessian { level, .. } = error else { panic!("{error}") };
            assert_eq!(level.index(), 3);
        }
    }
}
