//! Products of rows with each other, and the Cholesky factorisation, in blocks that fit into the
//! cache.

use ndarray::{Array1, Array2, ArrayView2, Axis, linalg::general_mat_mul, s};

/// Number of rows of a block.
const BLOCK: usize = 96;

/// Returns the lower triangle of X Xᵀ. The elements above it are undefined.
pub(super) fn lower_products(rows: ArrayView2<'_, f64>) -> Array2<f64> {
    let count = rows.nrows();
    let mut products = Array2::zeros((count, count));
    for (start, end) in blocks(0, count) {
        let block = rows.slice(s![start..end, ..]);
        let mut target = products.slice_mut(s![start..end, ..end]);
        let others = rows.slice(s![..end, ..]);
        general_mat_mul(1.0, &block, &others.t(), 0.0, &mut target);
    }
    products
}

/// Adds Xᵀ X to the lower triangle of a matrix.
pub(super) fn add_lower_products_of_columns(rows: ArrayView2<'_, f64>, sum: &mut Array2<f64>) {
    for (start, end) in blocks(0, rows.ncols()) {
        let block = rows.slice(s![.., start..end]);
        let mut target = sum.slice_mut(s![start..end, ..end]);
        general_mat_mul(1.0, &block.t(), &rows.slice(s![.., ..end]), 1.0, &mut target);
    }
}

/// The factor L of A = L Lᵀ.
#[derive(Debug)]
pub(super) struct Cholesky {
    lower: Array2<f64>,
}

impl Cholesky {
    /// Factors a symmetric positive definite matrix, given by its lower triangle. A pivot that is
    /// smaller than `least` by rounding is replaced by `least`.
    pub(super) fn factor(mut matrix: Array2<f64>, least: f64) -> Self {
        let size = matrix.nrows();
        for (start, end) in blocks(0, size) {
            let (mut above, mut below) = matrix.view_mut().split_at(Axis(0), end);
            let mut pivot = above.slice_mut(s![start.., start..end]);
            factor_small(&mut pivot, least);
            // The rows below are the solution X of X Lᵀ = A.
            let inverse = inverse_of_lower(pivot.view());
            let rows = below.slice(s![.., start..end]).to_owned();
            let mut target = below.slice_mut(s![.., start..end]);
            general_mat_mul(1.0, &rows, &inverse.t(), 0.0, &mut target);
            let panel = below.slice(s![.., start..end]).to_owned();
            for (first, last) in blocks(end, size) {
                let own = panel.slice(s![first - end..last - end, ..]);
                let rows = panel.slice(s![first - end.., ..]);
                let mut target = below.slice_mut(s![first - end.., first..last]);
                general_mat_mul(-1.0, &rows, &own.t(), 1.0, &mut target);
            }
        }
        Self { lower: matrix }
    }

    /// Returns the solution x of A x = b.
    pub(super) fn solve(&self, mut vector: Array1<f64>) -> Array1<f64> {
        let size = vector.len();
        for row in 0..size {
            let known = self.lower.slice(s![row, ..row]).dot(&vector.slice(s![..row]));
            vector[row] = (vector[row] - known) / self.lower[[row, row]];
        }
        for row in (0..size).rev() {
            let value = vector[row] / self.lower[[row, row]];
            vector[row] = value;
            let coefficients = self.lower.slice(s![row, ..row]);
            vector.slice_mut(s![..row]).scaled_add(-value, &coefficients);
        }
        vector
    }
}

/// Factors a block, row by row.
fn factor_small(matrix: &mut ndarray::ArrayViewMut2<'_, f64>, least: f64) {
    for row in 0..matrix.nrows() {
        for column in 0..=row {
            let sum: f64 = (0..column).map(|k| matrix[[row, k]] * matrix[[column, k]]).sum();
            let rest = matrix[[row, column]] - sum;
            matrix[[row, column]] = if row == column {
                rest.max(least).sqrt()
            } else {
                rest / matrix[[column, column]]
            };
        }
    }
}

/// Returns L⁻¹ of a block. The elements above its diagonal are not read.
fn inverse_of_lower(lower: ArrayView2<'_, f64>) -> Array2<f64> {
    let size = lower.nrows();
    let mut inverse = Array2::zeros((size, size));
    for column in 0..size {
        for row in column..size {
            let sum: f64 = (column..row).map(|k| lower[[row, k]] * inverse[[k, column]]).sum();
            let unit = f64::from(u8::from(row == column));
            inverse[[row, column]] = (unit - sum) / lower[[row, row]];
        }
    }
    inverse
}

/// Returns the ranges from `start` to `end` in steps of a block.
fn blocks(start: usize, end: usize) -> impl Iterator<Item = (usize, usize)> {
    (start..end).step_by(BLOCK).map(move |first| (first, (first + BLOCK).min(end)))
}

#[cfg(test)]
mod tests {
    use ndarray::{Array1, Array2};

    use super::{BLOCK, Cholesky, add_lower_products_of_columns, lower_products};

    /// A x = b holds for sizes around a block's, and both ways to compute A agree.
    #[test]
    #[allow(clippy::unwrap_used)]
    fn solves_across_blocks() {
        for size in [1, 7, BLOCK, BLOCK + 1, 2 * BLOCK + 5] {
            let rows = Array2::from_shape_fn((size, size + 3), |(i, j)| {
                ((i * 37 + j * 91 + i * j) % 101) as f64 / 50.0 - 1.0
            });
            let full = rows.dot(&rows.t()) + Array2::<f64>::eye(size);
            let mut sum = Array2::eye(size);
            add_lower_products_of_columns(rows.t(), &mut sum);
            let right = Array1::from_shape_fn(size, |i| 1.0 + (i % 5) as f64);
            for lower in [lower_products(rows.view()) + Array2::<f64>::eye(size), sum] {
                let solution = Cholesky::factor(lower, 0.0).solve(right.clone());
                let error = (&full.dot(&solution) - &right).mapv(f64::abs);
                assert!(error.iter().all(|error| *error < 1e-9), "{size}");
            }
        }
    }
}
