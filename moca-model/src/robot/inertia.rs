//! How heavy the robot is to its own joints.

use nalgebra::DMatrix;
use whole_body::Posed;

/// M⁻¹, the inverse of the joint-space inertia, at the robot's configuration.
#[derive(Debug, Clone)]
pub(super) struct InverseInertia {
    /// M, then what its factor L, M = L Lᵀ, is the inverse of: L⁻¹.
    factor: DMatrix<f64>,
    inverse: DMatrix<f64>,
    known: bool,
}

impl InverseInertia {
    /// For a robot with n joints, not known yet.
    pub(super) fn new(n: usize) -> Self {
        Self { factor: DMatrix::zeros(n, n), inverse: DMatrix::zeros(n, n), known: false }
    }

    /// The robot has moved: it is not known.
    pub(super) fn forget(&mut self) {
        self.known = false;
    }

    /// Computes it for the robot's configuration. Allocates nothing.
    pub(super) fn update(&mut self, posed: &mut Posed<'_>) {
        let Self { factor, inverse, known } = self;
        let n = factor.nrows();
        *known =
            n > 0 && posed.mass_matrix_into(factor).is_ok() && factorise(factor.as_mut_slice(), n);
        if *known {
            invert_triangle(factor.as_mut_slice(), n);
            multiply_by_transposed(factor.as_slice(), inverse.as_mut_slice(), n);
        }
    }

    /// n × n; none for a robot with a joint that moves no mass.
    pub(super) fn get(&self) -> Option<&DMatrix<f64>> {
        self.known.then_some(&self.inverse)
    }
}

/// Overwrites the lower triangle of M, n × n by columns, with its Cholesky factor L, on the diagonal with 1/Lᵢᵢ.
/// Returns false if there is none.
fn factorise(matrix: &mut [f64], n: usize) -> bool {
    for first in 0..n {
        let (column, behind) = matrix[first * n..].split_at_mut(n);
        let root = column[first].sqrt();
        let has_factor = root > 0.0;
        if !has_factor {
            return false;
        }
        column[first] = 1.0 / root;
        column[first + 1..].iter_mut().for_each(|entry| *entry /= root);
        for (row, other) in (first + 1..n).zip(behind.chunks_exact_mut(n)) {
            let weight = column[row];
            for (entry, own) in other[row..].iter_mut().zip(&column[row..]) {
                *entry -= weight * own;
            }
        }
    }
    true
}

/// Overwrites L, with 1/Lᵢᵢ on its diagonal, with L⁻¹: column j solves L x = eⱼ.
fn invert_triangle(factor: &mut [f64], n: usize) {
    for first in 0..n {
        let (column, behind) = factor[first * n..].split_at_mut(n);
        let own = column[first];
        column[first + 1..].iter_mut().for_each(|entry| *entry *= -own);
        for (row, other) in (first + 1..n).zip(behind.chunks_exact(n)) {
            let solved = column[row] * other[row];
            column[row] = solved;
            for (entry, factor) in column[row + 1..].iter_mut().zip(&other[row + 1..]) {
                *entry -= solved * factor;
            }
        }
    }
}

/// Writes L⁻ᵀ L⁻¹ for a lower triangle L⁻¹.
fn multiply_by_transposed(triangle: &[f64], out: &mut [f64], n: usize) {
    for (row, one) in triangle.chunks_exact(n).enumerate() {
        for (column, other) in triangle.chunks_exact(n).enumerate().take(row + 1) {
            let entry = one[row..].iter().zip(&other[row..]).map(|(a, b)| a * b).sum();
            out[column * n + row] = entry;
            out[row * n + column] = entry;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_inverse_times_the_matrix_is_one(
            n in 1..12_usize, entries in prop::collection::vec(-1.0..1.0_f64, 144),
        ) {
            let root = DMatrix::from_column_slice(n, n, &entries[..n * n]);
            let matrix = &root * root.transpose() + DMatrix::identity(n, n) * 0.1;
            let mut factor = matrix.clone();
            let mut inverse = DMatrix::zeros(n, n);
            prop_assert!(factorise(factor.as_mut_slice(), n));
            invert_triangle(factor.as_mut_slice(), n);
            multiply_by_transposed(factor.as_slice(), inverse.as_mut_slice(), n);
            prop_assert!((matrix * inverse - DMatrix::identity(n, n)).amax() < 1e-10);
        }

        #[test]
        fn a_matrix_that_is_not_positive_definite_has_no_factor(
            n in 1..12_usize, entries in prop::collection::vec(-1.0..1.0_f64, 144), at in 0..12_usize,
        ) {
            let root = DMatrix::from_column_slice(n, n, &entries[..n * n]);
            let mut matrix = &root * root.transpose();
            let at = at % n;
            matrix[(at, at)] = -matrix[(at, at)];
            prop_assert!(!factorise(matrix.as_mut_slice(), n));
        }
    }
}
