//! Matrices from which coefficients are copied.

use nalgebra::{Dim, Matrix, RawStorage};

/// A matrix of coefficients, with one row for each constraint or target. It is implemented for
/// nalgebra's matrices of any size and storage. The feature `faer` adds faer's matrices and views.
///
#[cfg_attr(
    feature = "faer",
    doc = r"
```
use ahqp_core::{Level, Objective, Rows};
use faer::{col, mat};

let (a, b) = (mat![[1.0, 2.0], [0.0, 1.0_f64]], col![3.0, 4.0_f64]);
let rows = Rows::equalities(&a, b.iter())?;
assert_eq!((rows.row(0), rows.upper()), (Some(&[1.0, 2.0][..]), &[3.0, 4.0][..]));

let hessian = &a.transpose() * &a;
let level = Level::quadratic(&hessian, b.iter())?;
assert!(matches!(level.objective(), Objective::Quadratic { hessian, .. } if hessian[(0, 1)] == 2.0));
# Ok::<(), ahqp_core::Error>(())
```"
)]
pub trait CoefficientMatrix {
    /// Number of rows.
    fn nrows(&self) -> usize;

    /// Number of columns.
    fn ncols(&self) -> usize;

    /// Returns the coefficient in a row and a column.
    fn entry(&self, row: usize, column: usize) -> f64;
}

impl<R: Dim, C: Dim, S: RawStorage<f64, R, C>> CoefficientMatrix for Matrix<f64, R, C, S> {
    fn nrows(&self) -> usize {
        self.nrows()
    }

    fn ncols(&self) -> usize {
        self.ncols()
    }

    fn entry(&self, row: usize, column: usize) -> f64 {
        self[(row, column)]
    }
}

#[cfg(feature = "faer")]
impl CoefficientMatrix for faer::Mat<f64> {
    fn nrows(&self) -> usize {
        self.nrows()
    }

    fn ncols(&self) -> usize {
        self.ncols()
    }

    fn entry(&self, row: usize, column: usize) -> f64 {
        self[(row, column)]
    }
}

#[cfg(feature = "faer")]
impl CoefficientMatrix for faer::MatRef<'_, f64> {
    fn nrows(&self) -> usize {
        self.nrows()
    }

    fn ncols(&self) -> usize {
        self.ncols()
    }

    fn entry(&self, row: usize, column: usize) -> f64 {
        self[(row, column)]
    }
}
