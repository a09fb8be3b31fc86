//! Singular values and right singular vectors, by one-sided Jacobi rotations.

use nalgebra::{DMatrix, DVector};

/// Largest number of sweeps over all pairs of columns. About ten are usual.
const SWEEPS: usize = 60;

/// Singular values of a matrix, in falling order, and all its right singular vectors as columns of
/// an orthogonal matrix. The vectors of the value zero are a basis of the nullspace.
///
/// Rotations make the columns orthogonal (Hestenes, "Inversion of matrices by biorthogonalization
/// and related results", 1958), so that small values keep their digits.
pub(super) struct RightSingular {
    pub(super) values: Vec<f64>,
    pub(super) vectors: DMatrix<f64>,
}

impl RightSingular {
    /// Computes the decomposition. None if the columns do not become orthogonal.
    pub(super) fn new(mut columns: DMatrix<f64>) -> Option<Self> {
        let n = columns.ncols();
        let mut vectors = DMatrix::identity(n, n);
        let zero = f64::EPSILON * columns.norm();
        let mut sweeps = 0;
        while sweep(&mut columns, &mut vectors, zero) {
            sweeps += 1;
            if sweeps == SWEEPS {
                return None;
            }
        }
        let norms = DVector::from_iterator(n, columns.column_iter().map(|column| column.norm()));
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by(|&one, &other| norms[other].total_cmp(&norms[one]));
        Some(Self {
            values: order.iter().map(|&column| norms[column]).collect(),
            vectors: vectors.select_columns(&order),
        })
    }
}

/// Makes each pair of columns orthogonal, except columns below `zero`. Returns true if a pair was
/// not orthogonal.
fn sweep(columns: &mut DMatrix<f64>, vectors: &mut DMatrix<f64>, zero: f64) -> bool {
    let mut any = false;
    for p in 0..columns.ncols() {
        for q in p + 1..columns.ncols() {
            let (a, b) = (columns.column(p).norm(), columns.column(q).norm());
            let product = columns.column(p).dot(&columns.column(q));
            // This form ends the sweep for NaN.
            if !(a.min(b) > zero && product.abs() > 4.0 * f64::EPSILON * a * b) {
                continue;
            }
            any = true;
            // This is the smaller of the two angles that make them orthogonal.
            let ratio = (b - a) * (b + a) / (2.0 * product);
            let tangent = 1.0_f64.copysign(ratio) / (ratio.abs() + ratio.hypot(1.0));
            let cosine = 1.0 / tangent.hypot(1.0);
            for matrix in [&mut *columns, &mut *vectors] {
                for row in 0..matrix.nrows() {
                    let (x, y) = (matrix[(row, p)], matrix[(row, q)]);
                    matrix[(row, p)] = cosine * (x - tangent * y);
                    matrix[(row, q)] = cosine * (y + tangent * x);
                }
            }
        }
    }
    any
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// A = U Σ Vᵀ, so VᵀAᵀA V is Σ², and V is orthogonal. Dependent columns have the value 0.
        #[test]
        fn singular_vectors_are_orthogonal_and_match_the_matrix(
            entries in prop::collection::vec(-3.0..3.0_f64, 30), rows in 1..6_usize, twice in any::<bool>(),
        ) {
            let mut matrix = DMatrix::from_fn(rows, 5, |i, j| entries[5 * i + j]);
            if twice {
                let first = matrix.column(0) * 2.0;
                matrix.set_column(4, &first);
            }
            let singular = RightSingular::new(matrix.clone()).unwrap();
            let v = &singular.vectors;
            prop_assert!((v.transpose() * v - DMatrix::identity(5, 5)).amax() < 1e-14);
            let reached = &matrix * v;
            for (column, value) in reached.column_iter().zip(&singular.values) {
                prop_assert!((column.norm() - value).abs() < 1e-13);
            }
            let products = reached.transpose() * &reached;
            let diagonal = DMatrix::from_diagonal(&products.diagonal());
            prop_assert!((products - diagonal).amax() < 1e-12);
            prop_assert!(singular.values.is_sorted_by(|one, next| one >= next));
            let rank = rows.min(if twice { 4 } else { 5 });
            prop_assert!(singular.values[rank..].iter().all(|value| *value < 1e-14));
        }
    }
}
