//! The row space of a matrix and its nullspace, by faer's singular value decomposition.

use faer::{Col, ColRef, Mat, MatRef};

/// A row depends on others when what they leave of it is below this fraction of it \[-\].
pub(super) const DEPENDENT: f64 = 1e-10;

/// A matrix B with orthonormal bases of its row space and of its nullspace, as columns.
pub(super) struct RowSpace<'a> {
    matrix: MatRef<'a, f64>,
    range: Mat<f64>,
    pub(super) nullspace: Mat<f64>,
}

impl<'a> RowSpace<'a> {
    /// Whether a row depends on others is judged relative to its entry in `sizes`. None, if the
    /// singular values do not converge.
    pub(super) fn new(matrix: MatRef<'a, f64>, sizes: &[f64]) -> Option<Self> {
        let (m, n) = matrix.shape();
        let scaled = |i: usize, j: usize| {
            if sizes[i] > 0.0 { matrix[(i, j)] / sizes[i] } else { 0.0 }
        };
        let singular = Mat::from_fn(m, n, scaled).svd().ok()?;
        let values = singular.S().column_vector().iter();
        let rank = values.take_while(|&&value| value > DEPENDENT).count();
        let range = singular.V().subcols(0, rank).to_owned();
        let nullspace = singular.V().subcols(rank, n - rank).to_owned();
        Some(Self { matrix, range, nullspace })
    }

    /// The point of least norm among those that minimise ½‖B y − c‖² + dᵀy, for d in the row
    /// space.
    pub(super) fn minimise(&self, c: ColRef<'_, f64>, d: ColRef<'_, f64>) -> Col<f64> {
        if self.range.ncols() == 0 {
            return Col::zeros(self.matrix.ncols());
        }
        // With B V = Q R, V the basis of the row space: y = V R⁻¹ (Qᵀc − R⁻ᵀ Vᵀd).
        let factor = (self.matrix * &self.range).qr();
        let r = factor.thin_R();
        let mut pull = self.range.transpose() * d;
        r.transpose().solve_lower_triangular_in_place(pull.as_mut());
        let mut y = factor.compute_thin_Q().transpose() * c - pull;
        r.solve_upper_triangular_in_place(y.as_mut());
        &self.range * y
    }
}

/// The norm of each row.
pub(super) fn row_norms(matrix: MatRef<'_, f64>) -> Vec<f64> {
    matrix.row_iter().map(|row| row.norm_l2()).collect()
}

/// The rows at `indices`.
pub(super) fn select_rows(matrix: MatRef<'_, f64>, indices: &[usize]) -> Mat<f64> {
    Mat::from_fn(indices.len(), matrix.ncols(), |i, j| matrix[(indices[i], j)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_has_the_whole_space_as_its_nullspace() {
        let none = Mat::<f64>::zeros(0, 3);
        let space = RowSpace::new(none.as_ref(), &[]).unwrap();
        assert_eq!(space.nullspace.shape(), (3, 3));
        let y = space.minimise(Col::zeros(0).as_ref(), Col::zeros(3).as_ref());
        assert_eq!(y.norm_l2(), 0.0);
    }

    #[test]
    fn dependent_rows_are_fitted_by_the_shortest_point() {
        // Rows 1 and 3 agree, row 2 is zero; the sum of the targets' misfits is least at y₀ = 1.5.
        let b = Mat::from_fn(3, 2, |i, j| if i != 1 && j == 0 { 2.0 } else { 0.0 });
        let space = RowSpace::new(b.as_ref(), &row_norms(b.as_ref())).unwrap();
        assert_eq!(space.nullspace.ncols(), 1);
        assert!((b.as_ref() * &space.nullspace).norm_max() < 1e-15);
        let c = Col::from_fn(3, |i| [2.0, 5.0, 4.0][i]);
        let y = space.minimise(c.as_ref(), Col::zeros(2).as_ref());
        assert!((y[0] - 1.5).abs() < 1e-15 && y[1].abs() < 1e-15);
        // The slope 4 along y₀ moves it by 4 / (2² + 2²).
        let d = Col::from_fn(2, |i| [4.0, 0.0][i]);
        let y = space.minimise(c.as_ref(), d.as_ref());
        assert!((y[0] - 1.0).abs() < 1e-15);
    }
}
