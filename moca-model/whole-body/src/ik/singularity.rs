//! Damping of targets near singular configurations.

use std::f64::consts::E;

use ahqp_core::Rows;

/// Takes from the targets of levels what their rows reach only by very large velocities.
///
/// Level by level, highest priority first, the rows are scaled to norm one and freed of what the
/// rows above determine; G = P Pᵀ then has the squared singular values σ² of what is left to the
/// level, and p² = det G / e is a lower bound of the least. Where p is above the threshold σ₀
/// nothing changes. Below, with the eigenvectors of W^½ G W^½, W being the weights of the
/// scaled rows over the largest,
/// the part of the target along each is multiplied by σ²/(σ² + μ²),
///
/// > μ² = (σ₀/2)² (1 − p²/σ₀²) (1 − σ²/σ₀²), or zero where σ > σ₀:
///
/// damped least squares, direction by direction (Nakamura and Hanafusa, Journal of Dynamic
/// Systems, Measurement and Control 108, 1986; Maciejewski and Klein, Journal of Robotic Systems
/// 5(6), 1988), continuous in the rows. What is damped is the difference from what the levels above
/// do by themselves. Rows that contradict each other keep their weighted compromise.
///
/// The levels stay rows with other targets: priorities and limits are not touched.
#[derive(Debug)]
pub(super) struct SingularityDamping {
    threshold: f64,
    columns: usize,
    /// Orthonormal rows that span those of the levels above.
    basis: Vec<f64>,
    count: usize,
    /// What the levels above do by themselves.
    point: Vec<f64>,
    projected: Vec<f64>,
    norms: Vec<f64>,
    /// √(weight · norm² over the largest).
    scales: Vec<f64>,
    residual: Vec<f64>,
    gram: Vec<f64>,
    factor: Vec<f64>,
    vectors: Vec<f64>,
    direction: Vec<f64>,
}

/// A direction that is left to a level by less than this belongs to the levels below.
const NOTHING: f64 = 1e-8;
/// Of the largest weight, what the others count as at least here.
const LIGHTEST: f64 = 1e-12;
/// Sweeps of Jacobi's method; six suffice for the sizes of tasks.
const SWEEPS: usize = 12;

impl SingularityDamping {
    /// For levels of up to `rows` rows over so many variables.
    pub(super) fn new(threshold: f64, rows: usize, columns: usize) -> Self {
        Self {
            threshold,
            columns,
            basis: vec![0.0; columns * columns],
            count: 0,
            point: vec![0.0; columns],
            projected: vec![0.0; rows * columns],
            norms: vec![0.0; rows],
            scales: vec![1.0; rows],
            residual: vec![0.0; rows],
            gram: vec![0.0; rows * rows],
            factor: vec![0.0; rows * rows],
            vectors: vec![0.0; rows * rows],
            direction: vec![0.0; columns],
        }
    }

    /// Begins with the highest level.
    pub(super) fn begin(&mut self) {
        self.count = 0;
        self.point.fill(0.0);
    }

    /// Damps the targets of the next level. A level with ranges, or with more rows than there is
    /// room for, is left as it is.
    pub(super) fn damp(&mut self, rows: &mut Rows) {
        let m = rows.len();
        let equalities = rows.lower().iter().eq(rows.upper());
        if self.threshold == 0.0 || m > self.norms.len() || !equalities {
            return;
        }
        self.load(rows);
        let closeness = self.factorise(m) / (E * self.threshold * self.threshold);
        if closeness >= 1.0 {
            self.take_all(m);
        } else {
            self.weigh(m, rows);
            self.take_by_direction(m, closeness, rows);
        }
    }

    /// Scales the rows, frees them of the basis, and computes G and what is missing to the targets.
    fn load(&mut self, rows: &Rows) {
        let n = self.columns;
        let basis = &self.basis[..self.count * n];
        for (i, (row, target, _)) in rows.iter().enumerate() {
            let norm = dot(row, row).sqrt();
            let norm = if norm > 0.0 { norm } else { 1.0 };
            let own = &mut self.projected[i * n..(i + 1) * n];
            own.iter_mut().zip(row).for_each(|(own, entry)| *own = entry / norm);
            self.residual[i] = target / norm - dot(own, &self.point);
            self.norms[i] = norm;
            for direction in basis.chunks_exact(n) {
                subtract(own, dot(own, direction), direction);
            }
        }
        let m = rows.len();
        for i in 0..m {
            for j in 0..=i {
                let [one, other] = [i, j].map(|k| &self.projected[k * n..(k + 1) * n]);
                let product = dot(one, other);
                self.gram[i * m + j] = product;
                self.gram[j * m + i] = product;
            }
        }
    }

    /// The Cholesky factor of G, and its determinant; zero where it is not positive. The smallest
    /// eigenvalue is at least the determinant over e, as the m − 1 others sum to at most m and so
    /// have a product of at most (1 + 1/(m − 1))^(m−1).
    fn factorise(&mut self, m: usize) -> f64 {
        self.factor[..m * m].copy_from_slice(&self.gram[..m * m]);
        let mut determinant = 1.0;
        for i in 0..m {
            let (done, rest) = self.factor.split_at_mut(i * m);
            let row = &mut rest[..m];
            for (j, other) in done.chunks_exact(m).enumerate() {
                row[j] = (row[j] - dot(&row[..j], &other[..j])) / other[j];
            }
            let pivot = row[i] - dot(&row[..i], &row[..i]);
            if pivot.is_nan() || pivot <= 0.0 {
                return 0.0;
            }
            determinant *= pivot;
            row[i] = pivot.sqrt();
        }
        determinant
    }

    /// All directions are well-conditioned: L⁻¹ P joins the basis, L⁻¹ r the point.
    fn take_all(&mut self, m: usize) {
        let n = self.columns;
        for i in 0..m {
            let (done, rest) = self.projected.split_at_mut(i * n);
            let own = &mut rest[..n];
            let row = &self.factor[i * m..(i + 1) * m];
            for (direction, factor) in done.chunks_exact(n).zip(row) {
                subtract(own, *factor, direction);
            }
            for entry in own.iter_mut() {
                *entry /= row[i];
            }
            let missing = self.residual[i] - dot(&row[..i], &self.residual[..i]);
            self.residual[i] = missing / row[i];
            subtract(&mut self.point, -self.residual[i], own);
            if self.count < n {
                self.basis[self.count * n..(self.count + 1) * n].copy_from_slice(own);
                self.count += 1;
            }
        }
    }

    /// Weighs rows, G and what is missing.
    fn weigh(&mut self, m: usize, rows: &Rows) {
        let heaviness = |norms: &[f64], row: usize| rows.weight(row) * norms[row] * norms[row];
        let largest = (0..m).map(|row| heaviness(&self.norms, row)).fold(0.0, f64::max);
        for row in 0..m {
            let part = if largest > 0.0 { heaviness(&self.norms, row) / largest } else { 1.0 };
            self.scales[row] = part.max(LIGHTEST).sqrt();
        }
        for i in 0..m {
            self.residual[i] *= self.scales[i];
            for j in 0..m {
                self.gram[i * m + j] *= self.scales[i] * self.scales[j];
            }
            let own = &mut self.projected[i * self.columns..(i + 1) * self.columns];
            for entry in own {
                *entry *= self.scales[i];
            }
        }
    }

    /// Takes each direction as far as it is well-conditioned, and the rest from the targets.
    fn take_by_direction(&mut self, m: usize, closeness: f64, rows: &mut Rows) {
        let n = self.columns;
        eigenvectors(&mut self.gram[..m * m], &mut self.vectors[..m * m], m);
        for k in 0..m {
            let sigma = self.gram[k * m + k].max(0.0).sqrt();
            // Row k of the matrix of vectors.
            let vector = &self.vectors[k * m..(k + 1) * m];
            let missing = dot(vector, &self.residual[..m]);
            let factor = self.factor_of(sigma, closeness);
            if factor < 1.0 {
                let sizes = self.norms.iter().zip(&self.scales);
                for (i, (part, (norm, scale))) in vector.iter().zip(sizes).enumerate() {
                    let change = part * (factor - 1.0) * missing * norm / scale;
                    let target = rows.lower()[i] + change;
                    rows.lower_mut()[i] = target;
                    rows.upper_mut()[i] = target;
                }
            }
            if sigma <= NOTHING || self.count == n {
                continue;
            }
            self.direction.fill(0.0);
            for (part, own) in vector.iter().zip(self.projected.chunks_exact(n)) {
                subtract(&mut self.direction, -part / sigma, own);
            }
            subtract(&mut self.point, -factor * missing / sigma, &self.direction);
            self.basis[self.count * n..(self.count + 1) * n].copy_from_slice(&self.direction);
            self.count += 1;
        }
    }

    /// σ²/(σ² + μ²).
    fn factor_of(&self, sigma: f64, closeness: f64) -> f64 {
        let square = (sigma / self.threshold).powi(2);
        if square >= 1.0 {
            return 1.0;
        }
        square / (square + 0.25 * (1.0 - closeness) * (1.0 - square))
    }
}

fn dot(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).map(|(a, b)| a * b).sum()
}

/// a ← a − factor · b.
fn subtract(a: &mut [f64], factor: f64, b: &[f64]) {
    a.iter_mut().zip(b).for_each(|(a, b)| *a -= factor * b);
}

/// Brings a symmetric m × m matrix to diagonal form, and writes its eigenvectors as rows: Jacobi's
/// method (Golub and Van Loan, *Matrix Computations*, 2013, Sec. 8.5).
fn eigenvectors(matrix: &mut [f64], vectors: &mut [f64], m: usize) {
    vectors.fill(0.0);
    vectors.iter_mut().step_by(m + 1).for_each(|entry| *entry = 1.0);
    for _ in 0..SWEEPS {
        let mut largest = 0.0_f64;
        for p in 0..m {
            for q in p + 1..m {
                let off = matrix[p * m + q];
                largest = largest.max(off.abs());
                if off.abs() < 1e-15 {
                    continue;
                }
                let ratio = (matrix[q * m + q] - matrix[p * m + p]) / (2.0 * off);
                let tangent = ratio.signum() / (ratio.abs() + (ratio * ratio + 1.0).sqrt());
                let cosine = 1.0 / (tangent * tangent + 1.0).sqrt();
                let sine = tangent * cosine;
                for k in 0..m {
                    let (one, other) = (matrix[k * m + p], matrix[k * m + q]);
                    matrix[k * m + p] = cosine * one - sine * other;
                    matrix[k * m + q] = sine * one + cosine * other;
                }
                for k in 0..m {
                    let (one, other) = (matrix[p * m + k], matrix[q * m + k]);
                    matrix[p * m + k] = cosine * one - sine * other;
                    matrix[q * m + k] = sine * one + cosine * other;
                    let (one, other) = (vectors[p * m + k], vectors[q * m + k]);
                    vectors[p * m + k] = cosine * one - sine * other;
                    vectors[q * m + k] = sine * one + cosine * other;
                }
            }
        }
        if largest < 1e-15 {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};
    use proptest::prelude::*;

    fn damped(a: &DMatrix<f64>, b: &[f64]) -> (Rows, SingularityDamping) {
        let mut rows = Rows::equalities(a, b).unwrap();
        let mut damping = SingularityDamping::new(0.1, a.nrows(), a.ncols());
        damping.begin();
        damping.damp(&mut rows);
        (rows, damping)
    }

    proptest! {
        #[test]
        fn targets_are_damped_along_singular_directions_only(
            entries in prop::collection::vec(-1.0..1.0_f64, 3 * 6),
            b in prop::collection::vec(-1.0..1.0_f64, 3), closeness in 1e-6..1.0_f64,
        ) {
            let mut a = DMatrix::from_row_slice(3, 6, &entries);
            let near = a.row(0) + a.row(2) * closeness;
            a.set_row(2, &near);
            prop_assume!(a.row_iter().all(|row| row.norm() > 0.1));
            let (rows, damping) = damped(&a, &b);
            // By the singular value decomposition of the rows as they weigh, for w = 1.
            let scale = DVector::from_iterator(3, a.row_iter().map(|row| row.norm()));
            let unit = DMatrix::from_fn(3, 6, |i, j| a[(i, j)] / scale[i]);
            let determinant = (&unit * unit.transpose()).determinant().max(0.0);
            let closeness = determinant / (std::f64::consts::E * 0.01);
            let svd = (&a / scale.max()).svd(true, false);
            let u = svd.u.unwrap();
            let mut parts = u.transpose() * DVector::from_column_slice(&b);
            for (part, sigma) in parts.iter_mut().zip(&svd.singular_values) {
                *part *= if closeness < 1.0 { damping.factor_of(*sigma, closeness) } else { 1.0 };
            }
            let expected = u * parts;
            let found = DVector::from_column_slice(rows.lower());
            prop_assert!((found - expected).norm() < 1e-7);
        }

        #[test]
        fn a_well_conditioned_level_keeps_its_targets(
            b in prop::collection::vec(-1.0..1.0_f64, 2), angle in 0.3..2.8_f64,
        ) {
            let a = DMatrix::from_row_slice(2, 3, &[1.0, 0.0, 0.0, angle.cos(), angle.sin(), 0.0]);
            let (rows, _) = damped(&a, &b);
            prop_assert_eq!(rows.lower(), &b[..]);
        }

        #[test]
        fn what_a_level_above_determines_is_damped_below(
            gap in 0.0..0.01_f64, b in -1.0..1.0_f64,
        ) {
            let mut damping = SingularityDamping::new(0.1, 1, 2);
            damping.begin();
            let mut above = Rows::equalities(&DMatrix::from_row_slice(1, 2, &[1.0, 0.0]), &[0.5]).unwrap();
            let below = DMatrix::from_row_slice(1, 2, &[1.0, gap]);
            let mut below = Rows::equalities(&below, &[b]).unwrap();
            damping.damp(&mut above);
            damping.damp(&mut below);
            prop_assert_eq!(above.lower()[0], 0.5);
            // x₀ = 0.5; what x₁ must add is damped.
            let needed = (below.lower()[0] - 0.5) / gap.max(1e-12);
            prop_assert!(needed.abs() <= 1.5 / 0.1 + 1e-9);
        }

        #[test]
        fn rows_that_contradict_each_other_keep_their_compromise(
            weight in 0.01..100.0_f64, one in -1.0..1.0_f64, other in -1.0..1.0_f64,
        ) {
            let a = DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 2.0, 0.0]);
            let mut rows = Rows::equalities(&a, &[one, 2.0 * other]).unwrap();
            rows.set_weights(&[weight, 0.25]).unwrap();
            let mut damping = SingularityDamping::new(0.1, 2, 2);
            damping.begin();
            damping.damp(&mut rows);
            // With rows of norm one the second weighs 0.25 · 4.
            let found = (weight * rows.lower()[0] + rows.lower()[1] * 0.5) / (weight + 1.0);
            let expected = (weight * one + other) / (weight + 1.0);
            prop_assert!((found - expected).abs() < 1e-9, "{found} for {expected}");
        }
    }
}
