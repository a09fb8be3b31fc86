//! Quadratic objectives as least squares: H = RᵀR by pivoted Cholesky factorisation.

use nalgebra::{DMatrix, DVector};

use crate::error::Error;
use crate::linalg::kernels::square;
use crate::linalg::list::List;
use crate::linalg::vector::dot;
use crate::problem::ids::LevelId;
use crate::problem::source::{ConstraintSource, Names};
use crate::solver::tolerances::{LINEAR, MODERATE, MODERATE_SQUARE, NO_CURVATURE, ROUNDING, SHAPE};

/// Diagonal value of a variable that is factored.
const IS_PIVOT: f64 = f64::NEG_INFINITY;

/// The form ½xᵀHx + gᵀx = ½‖Rx − b‖² + linearᵀx + constant.
///
/// R has as many rows as H has rank. The linear part is the part of the gradient outside the range
/// of H. It is zero for objectives that are bounded below everywhere.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct QuadraticFactor {
    n: usize,
    rank: usize,
    /// R, row by row.
    factor: Vec<f64>,
    target: Vec<f64>,
    /// Rounding of the target, and the factor by which the relative rounding of a row is amplified.
    target_rounding: Vec<f64>,
    amplification: Vec<f64>,
    pivots: List<usize>,
    /// Variables with curvature. Most Hessians of a stack of tasks have few.
    curved: List<usize>,
    /// Part of the diagonal that is not factored yet, or [`IS_PIVOT`] for pivots.
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
            curved: List::with_capacity(n),
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

    /// Returns the variable whose row of H produced a row of R.
    pub(crate) fn pivot(&self, index: usize) -> Option<usize> {
        self.pivots.get(index).copied()
    }

    /// Returns the rounding of a row's entries, relative to the row, in units of ordinary rounding.
    /// The second value is the rounding of its target. A small pivot of large terms increases both.
    pub(crate) fn rounding(&self, index: usize) -> (f64, f64) {
        (self.amplification[index], self.target_rounding[index])
    }

    /// Copies the linear part. Returns true if it is not zero.
    pub(crate) fn linear(&self, out: &mut [f64]) -> bool {
        out.copy_from_slice(&self.linear);
        self.linear.iter().any(|entry| *entry != 0.0)
    }

    /// Converts multipliers of rows of R to multipliers of rows of H: `(row of H, multiplier)`.
    pub(crate) fn to_hessian_rows(&self, multipliers: &[f64]) -> Vec<(usize, f64)> {
        let n = self.n;
        let mut z = multipliers.to_vec();
        // H at the pivots is (R at the pivots)ᵀ R, so μᵀR = ((R at the pivots)⁻¹μ)ᵀ (H at the
        // pivots).
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
        let squares = square(hessian.as_slice()) + square(gradient.as_slice());
        let are_moderate = squares < MODERATE_SQUARE;
        if !are_moderate {
            check_finite(level, hessian, gradient)?;
            check_moderate(level, hessian.amax().max(gradient.amax()))?;
        }
        self.rank = 0;
        self.pivots.clear();
        for i in 0..n {
            self.diagonal[i] = hessian[(i, i)];
        }
        self.curved.clear();
        self.curved.extend((0..n).filter(|&i| hessian[(i, i)] > 0.0));
        let is_block = self.is_block_of_curved(hessian);
        if !is_block || !self.is_exactly_symmetric(hessian) {
            check_symmetric(level, hessian)?;
        }
        if !is_block {
            self.check_flat(level, hessian)?;
        }
        while self.rank < n {
            let Some(pivot) = self.best_pivot(hessian) else { break };
            self.eliminate(hessian, pivot);
        }
        self.check_remainder(level, hessian)?;
        self.split_gradient(hessian, gradient);
        Ok(())
    }

    /// Returns true if only variables with curvature have entries.
    fn is_block_of_curved(&self, hessian: &DMatrix<f64>) -> bool {
        let n = self.n;
        let flat = |&i: &usize| self.diagonal[i] <= 0.0;
        // A sum of squares may round to zero although not all entries are zero. The bits do not.
        let bits = |bits: u64, entry: &f64| bits | (entry.to_bits() << 1);
        let columns = hessian.as_slice().chunks_exact(n.max(1)).enumerate();
        let all = columns.fold(0, |all, (column, entries)| {
            if flat(&column) {
                entries.iter().fold(all, bits)
            } else {
                let entries = (0..n).filter(flat).map(|row| &entries[row]);
                entries.fold(all, bits)
            }
        });
        all == 0
    }

    /// Returns true if the entries of variables with curvature are exactly symmetric.
    fn is_exactly_symmetric(&self, hessian: &DMatrix<f64>) -> bool {
        let mut curved = self.curved.iter().enumerate();
        curved.all(|(count, &i)| {
            self.curved[..count].iter().all(|&j| hessian[(i, j)] == hessian[(j, i)])
        })
    }

    /// Returns the variable with the largest remaining share of its curvature, whatever its unit.
    fn best_pivot(&self, hessian: &DMatrix<f64>) -> Option<usize> {
        let share = |i: usize| self.diagonal[i] / hessian[(i, i)];
        let curved = self.curved.iter().copied();
        curved.filter(|&i| share(i) > NO_CURVATURE).max_by(|&i, &j| share(i).total_cmp(&share(j)))
    }

    fn eliminate(&mut self, hessian: &DMatrix<f64>, pivot: usize) {
        let (n, rank) = (self.n, self.rank);
        let root = self.diagonal[pivot].sqrt();
        let (done, rest) = self.factor.split_at_mut(rank * n);
        let row = &mut rest[..n];
        row.fill(0.0);
        for &j in &self.curved {
            row[j] = hessian[(pivot, j)];
        }
        for above in done.chunks_exact(n) {
            crate::linalg::vector::add_scaled(row, -above[pivot], above);
        }
        for &j in &self.curved {
            row[j] = if self.diagonal[j] == IS_PIVOT { 0.0 } else { row[j] / root };
        }
        row[pivot] = root;
        self.amplification[rank] = hessian[(pivot, pivot)].sqrt() / root;
        for (left, entry) in self.diagonal.iter_mut().zip(row.iter()) {
            *left -= entry * entry;
        }
        self.diagonal[pivot] = IS_PIVOT;
        self.pivots.push(pivot);
        self.rank += 1;
    }

    /// Checks that rows without curvature are zero, as in every positive semidefinite matrix.
    fn check_flat(&self, level: usize, hessian: &DMatrix<f64>) -> Result<(), Error> {
        let n = self.n;
        for i in (0..n).filter(|i| !self.curved.contains(i)) {
            let mut entries = std::iter::once(i).chain(0..n).map(|row| hessian[(row, i)]);
            if let Some(entry) = entries.find(|&entry| entry != 0.0) {
                return Err(indefinite(level, i, entry));
            }
        }
        Ok(())
    }

    /// Checks that the remainder after the last positive pivot is zero, as in every positive
    /// semidefinite matrix.
    fn check_remainder(&self, level: usize, hessian: &DMatrix<f64>) -> Result<(), Error> {
        let n = self.n;
        let rest = || self.curved.iter().copied().filter(|&i| self.diagonal[i] != IS_PIVOT);
        for i in rest() {
            for j in rest().take_while(|&j| j <= i) {
                let product: f64 =
                    self.factor[..self.rank * n].chunks_exact(n).map(|row| row[i] * row[j]).sum();
                let remainder = hessian[(i, j)] - product;
                if remainder.abs() > SHAPE * largest_entry(hessian, i, j) {
                    return Err(indefinite(level, i, remainder));
                }
            }
        }
        Ok(())
    }

    /// Computes b with (Rᵀb)ᵢ = −gᵢ at the pivots. The rest of g is linear.
    fn split_gradient(&mut self, hessian: &DMatrix<f64>, gradient: &DVector<f64>) {
        for i in 0..self.rank {
            let pivot = self.pivots[i];
            let left = self.left_of_gradient(hessian, gradient, pivot, i);
            let root = self.factor[i * self.n + pivot];
            self.target[i] = -left.value / root;
            self.target_rounding[i] = left.rounding / root;
        }
        for j in 0..self.n {
            let left = self.left_of_gradient(hessian, gradient, j, self.rank);
            let is_linear = self.diagonal[j] != IS_PIVOT
                && left.value.abs() > LINEAR * left.size + left.rounding;
            self.linear[j] = if is_linear { left.value } else { 0.0 };
        }
    }

    /// Returns gⱼ plus the contribution of the first rows of R and their targets.
    fn left_of_gradient(
        &self,
        hessian: &DMatrix<f64>,
        gradient: &DVector<f64>,
        j: usize,
        rows: usize,
    ) -> Left {
        let value = gradient[j];
        let mut left = Left { value, size: value.abs(), rounding: ROUNDING * value.abs() };
        let largest = hessian[(j, j)].max(0.0).sqrt();
        for i in 0..rows {
            let (entry, target) = (self.factor[i * self.n + j], self.target[i]);
            left.value += entry * target;
            left.size += (entry * target).abs();
            // An entry of R is a difference of terms of up to √Hⱼⱼ times the amplification.
            let of_entry = ROUNDING * self.amplification[i] * largest;
            left.rounding += of_entry * target.abs() + entry.abs() * self.target_rounding[i];
        }
        left
    }
}

/// Remainder of an entry of the gradient, the size of its terms, and its rounding.
struct Left {
    value: f64,
    size: f64,
    rounding: f64,
}

fn indefinite(level: usize, variable: usize, pivot: f64) -> Error {
    let (level, names) = (LevelId::new(level), Names::default());
    let wanted = "positive semidefinite; project it onto the convex cone first";
    Error::Hessian { level, wanted, row: variable, column: variable, got: pivot, names }
}

fn check_finite(
    level: usize,
    hessian: &DMatrix<f64>,
    gradient: &DVector<f64>,
) -> Result<(), Error> {
    let find = |values: &[f64]| values.iter().position(|v| !v.is_finite());
    let not_finite = |what, row, entry, got| {
        let level = LevelId::new(level);
        Error::not_finite(what, ConstraintSource::Objective { level, row }, entry, got)
    };
    if !dot(hessian.as_slice(), hessian.as_slice()).is_finite()
        && let Some(entry) = find(hessian.as_slice())
    {
        let rows = hessian.nrows().max(1);
        let (row, entry) = (entry % rows, entry / rows);
        return Err(not_finite("the Hessian", row, entry, hessian[(row, entry)]));
    }
    if let Some(entry) = find(gradient.as_slice()) {
        return Err(not_finite("the gradient", entry, entry, gradient[entry]));
    }
    Ok(())
}

fn check_moderate(level: usize, value: f64) -> Result<(), Error> {
    if value <= MODERATE {
        return Ok(());
    }
    let source_of_row = ConstraintSource::Objective { level: LevelId::new(level), row: 0 };
    Err(Error::too_large(source_of_row, value))
}

/// Returns the largest possible entry (i, j) of a positive semidefinite matrix with this diagonal.
fn largest_entry(hessian: &DMatrix<f64>, i: usize, j: usize) -> f64 {
    // The roots are multiplied, since the product of two entries may leave the range of doubles.
    hessian[(i, i)].max(0.0).sqrt() * hessian[(j, j)].max(0.0).sqrt()
}

fn check_symmetric(level: usize, hessian: &DMatrix<f64>) -> Result<(), Error> {
    for row in 0..hessian.nrows() {
        for column in 0..row {
            let difference = (hessian[(row, column)] - hessian[(column, row)]).abs();
            if difference > 0.0 && difference > SHAPE * largest_entry(hessian, row, column) {
                let (level, names) = (LevelId::new(level), Names::default());
                let wanted = "symmetric; pass (H + Hᵀ)/2";
                return Err(Error::Hessian { level, wanted, row, column, got: difference, names });
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

    fn verdict(hessian: &DMatrix<f64>) -> Result<(), Error> {
        let n = hessian.nrows();
        QuadraticFactor::new(n).factorise(3, hessian, &DVector::zeros(n))
    }

    /// Returns a large or small diagonal block beside one of size 2.
    fn beside(entry: f64, block: [f64; 4]) -> DMatrix<f64> {
        let mut hessian = DMatrix::zeros(3, 3);
        hessian[(0, 0)] = entry;
        hessian.view_mut((1, 1), (2, 2)).copy_from(&DMatrix::from_row_slice(2, 2, &block));
        hessian
    }

    #[test]
    fn a_block_is_judged_by_its_own_entries() {
        for size in [1e-12, 1.0, 1e12] {
            for entry in [1e-10, 1.0, 1e10] {
                let verdict = |block: [f64; 4]| verdict(&beside(entry, block.map(|b| b * size)));
                let error = verdict([5.0, 2.0, -2.0, 5.0]).unwrap_err();
                assert!(matches!(error, Error::Hessian { row: 2, column: 1, .. }));
                let error = verdict([1.0, 2.0, 2.0, 1.0]).unwrap_err();
                assert!(
                    matches!(error, Error::Hessian { level, .. } if level.index() == 3),
                    "{error}"
                );
                let error = verdict([1.0, 0.0, 0.0, -1.0]).unwrap_err();
                assert!(matches!(error, Error::Hessian { row: 2, column: 2, .. }), "{error}");
                verdict([2.0, 1.0, 1.0, 2.0]).unwrap();
                verdict([1.0, 1.0, 1.0, 1.0]).unwrap();
            }
        }
    }

    /// Returns the verdict of the check, without place and size.
    fn kind(hessian: &DMatrix<f64>) -> &'static str {
        match verdict(hessian) {
            Ok(()) => "convex",
            Err(Error::Hessian { wanted, .. }) if wanted.starts_with("symmetric") => "asymmetric",
            Err(Error::Hessian { .. }) => "indefinite",
            Err(error) => panic!("{error}"),
        }
    }

    proptest! {
        #[test]
        fn units_of_the_variables_change_no_verdict(
            entries in prop::collection::vec(-2.0_f64..2.0, 3 * 5),
            units in prop::collection::vec(-6.0_f64..6.0, 5),
            change in prop_oneof![Just(0.0_f64), -1e-2..-1e-6, 1e-6..1e-2],
            at in (0..5_usize, 0..5_usize),
        ) {
            let half = DMatrix::from_row_slice(3, 5, &entries);
            let mut hessian = half.transpose() * &half;
            let sizes: Vec<f64> = hessian.diagonal().iter().map(|entry| entry.sqrt()).collect();
            // The rank is 3. A smaller diagonal entry makes the matrix indefinite, and another
            // entry elsewhere asymmetric.
            let change = if at.0 == at.1 { -change.abs() } else { change };
            hessian[at] += change * sizes[at.0] * sizes[at.1];
            let expected = match (change == 0.0, at.0 == at.1) {
                (true, _) => "convex",
                (false, true) => "indefinite",
                (false, false) => "asymmetric",
            };
            let unit = |i: usize| 10_f64.powf(units[i]);
            let scaled = DMatrix::from_fn(5, 5, |i, j| unit(i) * hessian[(i, j)] * unit(j));
            prop_assert_eq!(kind(&hessian), expected);
            prop_assert_eq!(kind(&scaled), expected);
            // The same change in both entries leaves only the curvature to judge.
            let symmetric = (&hessian + hessian.transpose()) * 0.5;
            let scaled = DMatrix::from_fn(5, 5, |i, j| unit(i) * symmetric[(i, j)] * unit(j));
            prop_assert_eq!(kind(&symmetric), kind(&scaled));
        }
    }

    /// Two variables are alike, and the gradient is zero at both. Each term there is rounding of
    /// the factor.
    #[test]
    fn rounding_of_the_factor_is_no_linear_part() {
        let hessian = DMatrix::from_row_slice(3, 3, &[1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 1.0, 2.0, 2.0]);
        let mut factor = QuadraticFactor::new(3);
        factor.factorise(0, &hessian, &DVector::from_row_slice(&[1.0, 0.0, 0.0])).unwrap();
        assert!(!factor.linear(&mut [0.0; 3]));
        // A real part is seen, however small.
        factor.factorise(0, &hessian, &DVector::from_row_slice(&[1.0, 1e-6, 0.0])).unwrap();
        assert!(factor.linear(&mut [0.0; 3]));
    }

    #[test]
    fn an_indefinite_hessian_is_refused() {
        let gradient = DVector::zeros(2);
        let mut factor = QuadraticFactor::new(2);
        for entries in [[1.0, 0.0, 0.0, -1.0], [0.0, 1.0, 1.0, 0.0], [1.0, 2.0, 2.0, 1.0]] {
            let hessian = DMatrix::from_row_slice(2, 2, &entries);
            let error = factor.factorise(3, &hessian, &gradient).unwrap_err();
            let Error::Hessian { level, .. } = error else { panic!("{error}") };
            assert_eq!(level.index(), 3);
        }
    }
}
