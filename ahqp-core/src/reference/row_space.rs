//! The row space of a matrix and its nullspace.

use nalgebra::{DMatrix, DVector};

use super::singular::RightSingular;

/// A row depends on others if they leave less than this fraction of it \[-\].
const DEPENDENT: f64 = 1e-10;

/// A matrix B with orthonormal bases of its row space and of its nullspace, as columns.
pub(super) struct RowSpace<'a> {
    matrix: &'a DMatrix<f64>,
    range: DMatrix<f64>,
    pub(super) nullspace: DMatrix<f64>,
}

impl<'a> RowSpace<'a> {
    /// Computes the bases. The dependence of a row is judged relative to its entry in `sizes`. None
    /// if the singular values do not converge.
    pub(super) fn new(matrix: &'a DMatrix<f64>, sizes: &[f64]) -> Option<Self> {
        let (m, n) = matrix.shape();
        let scaled = |i: usize, j: usize| {
            if sizes[i] > 0.0 { matrix[(i, j)] / sizes[i] } else { 0.0 }
        };
        let singular = RightSingular::new(DMatrix::from_fn(m, n, scaled))?;
        let rank = singular.values.iter().take_while(|value| **value > DEPENDENT).count();
        let range = singular.vectors.columns(0, rank).into_owned();
        let nullspace = singular.vectors.columns(rank, n - rank).into_owned();
        Some(Self { matrix, range, nullspace })
    }

    /// Returns the point of least norm among those that minimise ½‖B y − c‖² + dᵀy, for d in the
    /// row space.
    pub(super) fn minimise(&self, c: &DVector<f64>, d: &DVector<f64>) -> DVector<f64> {
        if self.range.ncols() == 0 {
            return DVector::zeros(self.matrix.ncols());
        }
        // y = V R⁻¹ (Qᵀc − R⁻ᵀ Vᵀd) for B V = Q R, where V is the basis of the row space.
        let factor = (self.matrix * &self.range).qr();
        let (q, r) = (factor.q(), factor.r());
        let pull = r.tr_solve_upper_triangular_unchecked(&(self.range.transpose() * d));
        let y = r.solve_upper_triangular_unchecked(&(q.transpose() * c - pull));
        &self.range * y
    }
}

/// Returns the norm of each row.
pub(super) fn row_norms(matrix: &DMatrix<f64>) -> Vec<f64> {
    matrix.row_iter().map(|row| row.norm()).collect()
}

/// Returns the rows at `indices`.
pub(super) fn select_rows(matrix: &DMatrix<f64>, indices: &[usize]) -> DMatrix<f64> {
    DMatrix::from_fn(indices.len(), matrix.ncols(), |i, j| matrix[(indices[i], j)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_has_the_whole_space_as_its_nullspace() {
        let none = DMatrix::zeros(0, 3);
        let space = RowSpace::new(&none, &[]).unwrap();
        assert_eq!(space.nullspace.shape(), (3, 3));
        let y = space.minimise(&DVector::zeros(0), &DVector::zeros(3));
        assert_eq!(y.norm(), 0.0);
    }

    #[test]
    fn dependent_rows_are_fitted_by_the_shortest_point() {
        // Rows 1 and 3 agree and row 2 is zero. The sum of squared deviations is least at y₀ = 1.5.
        let b = DMatrix::from_fn(3, 2, |i, j| if i != 1 && j == 0 { 2.0 } else { 0.0 });
        let space = RowSpace::new(&b, &row_norms(&b)).unwrap();
        assert_eq!(space.nullspace.ncols(), 1);
        assert!((&b * &space.nullspace).amax() < 1e-15);
        let c = DVector::from_column_slice(&[2.0, 5.0, 4.0]);
        let y = space.minimise(&c, &DVector::zeros(2));
        assert!((y[0] - 1.5).abs() < 1e-15 && y[1].abs() < 1e-15);
        // The slope 4 along y₀ moves it by 4 / (2² + 2²).
        let y = space.minimise(&c, &DVector::from_column_slice(&[4.0, 0.0]));
        assert!((y[0] - 1.0).abs() < 1e-15);
    }
}
