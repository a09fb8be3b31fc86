//! Damping of equality levels near singularities.

use crate::error::Error;
use crate::linalg::vector::{dot, solve_positive_definite};
use crate::problem::rows::Rows;

/// Takes from a level's targets what its rows reach only by very large solutions.
///
/// Where rows of A nearly depend on each other, A χ = b needs solutions of size ‖b‖/σ, σ being the
/// smallest singular value. Damped least squares, min ‖A χ − b‖² + μ²‖χ‖² (Nakamura & Hanafusa,
/// Journal of Dynamic Systems, Measurement and Control 108, 1986; Wampler, IEEE Transactions on
/// Systems, Man, and Cybernetics 16, 1986), bounds them by ‖b‖/(2μ). Its solution reaches
///
/// > b' = A Aᵀ (A Aᵀ + μ²I)⁻¹ b,
///
/// and the level with the target b' asks for just that: nothing else of the hierarchy changes, the
/// levels below keep every direction that they had, and a certificate proves the damped problem.
///
/// μ² = μ_max² (1 − (p/p₀)²) where p, the smallest pivot of the Cholesky factorisation of A Aᵀ
/// (rows scaled to norm one), lies below p₀; far from singularities nothing changes at all. p is at
/// least σ, and continuous in A as b' is. Ranks lost only because of higher levels are not seen.
///
/// ```
/// use ahqp_core::{Damping, Rows};
/// use nalgebra::{dmatrix, dvector};
///
/// # fn main() -> Result<(), ahqp_core::Error> {
/// let mut damping = Damping::new(2, 0.1, 0.05)?;
/// // Two rows that nearly agree: met exactly, they need |x| = 1000.
/// let mut rows = Rows::equalities(&dmatrix![1.0, 0.0; 1.0, 1e-3], &dvector![0.0, 1.0])?;
/// assert!(damping.apply(&mut rows)? > 0.0);
/// assert!((rows.lower()[1] - rows.lower()[0]).abs() < 0.01);
///
/// // Applied again it changes nothing more.
/// let once = rows.clone();
/// damping.apply(&mut rows)?;
/// assert_eq!(rows, once);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Damping {
    rows: usize,
    threshold: f64,
    largest: f64,
    norms: Vec<f64>,
    gram: Vec<f64>,
    system: Vec<f64>,
    target: Vec<f64>,
}

impl Damping {
    /// For levels of up to `rows` rows. `threshold` is p₀ and `largest` μ_max, both relative to the
    /// norms of the rows.
    ///
    /// # Errors
    /// [`Error::Value`] when either does not lie between 0 and 1, both excluded.
    pub fn new(rows: usize, threshold: f64, largest: f64) -> Result<Self, Error> {
        for (name, value) in [("threshold", threshold), ("largest", largest)] {
            if !(value > 0.0 && value < 1.0) {
                return Err(Error::value(name, value, "between 0 and 1"));
            }
        }
        Ok(Self {
            rows,
            threshold,
            largest,
            norms: vec![0.0; rows],
            gram: vec![0.0; rows * rows],
            system: vec![0.0; rows * rows],
            target: vec![0.0; rows],
        })
    }

    /// Damps the targets of `rows` where its matrix is nearly singular, and returns the μ used;
    /// zero where it is not. Allocates only the first time that rows are damped.
    ///
    /// The rows remember the targets that they were given: damped again, whether their matrix has
    /// changed or not, they are damped from those; where a bound is written, it is one of those. A
    /// zero row, and rows more than variables, leave a pivot of zero: the damping is then the largest
    /// throughout.
    ///
    /// # Errors
    /// [`Error::Size`] for more rows than sized for; [`Error::Value`] for a row whose bounds differ or
    /// that is not finite.
    pub fn apply(&mut self, rows: &mut Rows) -> Result<f64, Error> {
        let m = rows.len();
        if m > self.rows {
            return Err(Error::Size { what: "the damped level", got: m, wanted: self.rows });
        }
        rows.undo_damping();
        self.load(rows)?;
        let smallest = self.smallest_pivot(m);
        if smallest >= self.threshold {
            return Ok(0.0);
        }
        let damping = self.largest * (1.0 - (smallest / self.threshold).powi(2)).sqrt();
        self.system[..m * m].copy_from_slice(&self.gram[..m * m]);
        for entry in self.system[..m * m].iter_mut().step_by(m + 1) {
            *entry += damping * damping;
        }
        for (i, (to, bound)) in self.target.iter_mut().zip(rows.lower()).enumerate() {
            *to = bound / self.norms[i];
        }
        solve_positive_definite(&mut self.system[..m * m], &mut self.target[..m]);
        let target = &self.target[..m];
        let rows_of_gram = self.gram[..m * m].chunks_exact(m).zip(&self.norms);
        rows.damp(rows_of_gram.map(|(row, norm)| dot(row, target) * norm));
        Ok(damping)
    }

    /// The Gram matrix of the rows, scaled to norm one; zero rows stay zero.
    fn load(&mut self, rows: &Rows) -> Result<(), Error> {
        let (m, n) = (rows.len(), rows.columns());
        for (i, (row, lower, upper)) in rows.iter().enumerate() {
            if lower != upper {
                let (what, wanted) = ("the width of damped row", "0: damp equalities only");
                return Err(Error::Value { what, index: Some(i), got: upper - lower, wanted });
            }
            let square = dot(row, row);
            if !(square + lower.abs()).is_finite() {
                let (what, wanted) = ("the squared norm of damped row", "finite");
                return Err(Error::Value {
                    what,
                    index: Some(i),
                    got: square + lower.abs(),
                    wanted,
                });
            }
            self.norms[i] = if square > 0.0 { square.sqrt() } else { 1.0 };
        }
        let entries = rows.coefficients();
        for i in 0..m {
            for j in 0..=i {
                let product = dot(&entries[i * n..(i + 1) * n], &entries[j * n..(j + 1) * n]);
                let scaled = product / (self.norms[i] * self.norms[j]);
                self.gram[i * m + j] = scaled;
                self.gram[j * m + i] = scaled;
            }
        }
        Ok(())
    }

    /// The root of the smallest pivot of the Gram matrix.
    fn smallest_pivot(&mut self, m: usize) -> f64 {
        self.system[..m * m].copy_from_slice(&self.gram[..m * m]);
        let mut smallest = f64::INFINITY;
        for i in 0..m {
            let (done, rest) = self.system.split_at_mut(i * m);
            let row = &mut rest[..m];
            for (j, other) in done.chunks_exact(m).enumerate() {
                let pivot = other[j];
                let known = dot(&row[..j], &other[..j]);
                row[j] = if pivot > 0.0 { (row[j] - known) / pivot } else { 0.0 };
            }
            row[i] = (row[i] - dot(&row[..i], &row[..i])).max(0.0).sqrt();
            smallest = smallest.min(row[i]);
        }
        smallest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_target_is_what_damped_least_squares_reaches(
            m in 1_usize..5, n in 5_usize..9, angle in 1e-9..1e-2_f64,
            entries in prop::collection::vec(-1.0..1.0_f64, 4 * 8),
            target in prop::collection::vec(-1.0..1.0_f64, 4),
        ) {
            let mut a = DMatrix::from_fn(m, n, |i, j| entries[i * 8 + j] * [1.0, 10.0, 100.0, 1e3][i]);
            if m > 1 {
                let near = a.row(0) * 10.0 + a.row(m - 1) * angle;
                a.set_row(m - 1, &near);
            }
            prop_assume!((0..m).all(|i| a.row(i).norm() > 1e-2));
            let b = DVector::from_column_slice(&target[..m]);
            let mut rows = Rows::equalities(&a, &b).unwrap();
            let mut damped = Damping::new(4, 0.1, 0.05).unwrap();
            let damping = damped.apply(&mut rows).unwrap();
            let found = DVector::from_column_slice(rows.lower());
            if damping == 0.0 {
                prop_assert_eq!(found, b);
            } else {
                // By the other formula, (AᵀA + μ²I)⁻¹Aᵀb, on rows scaled to norm one.
                let scale = DMatrix::from_diagonal(&DVector::from_fn(m, |i, _| 1.0 / a.row(i).norm()));
                let (unit, scaled) = (&scale * &a, &scale * &b);
                let normal = unit.transpose() * &unit + DMatrix::identity(n, n) * damping.powi(2);
                let x = normal.lu().solve(&(unit.transpose() * &scaled)).unwrap();
                prop_assert!((&a * &x - found).norm() < 1e-9 * (1.0 + a.norm()));
                prop_assert!(x.norm() <= scaled.norm() / (2.0 * damping) * (1.0 + 1e-9));
            }
        }
    }

    #[test]
    fn rows_are_damped_from_the_targets_that_they_were_given() {
        let mut damping = Damping::new(2, 0.1, 0.05).unwrap();
        let near = DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 1.0, 1e-3]);
        let nearer = DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 1.0, 1e-4]);
        let far = DMatrix::identity(2, 2);
        let fresh = |damping: &mut Damping, matrix: &DMatrix<f64>, targets: [f64; 2]| {
            let mut rows = Rows::equalities(matrix, &targets).unwrap();
            damping.apply(&mut rows).unwrap();
            (rows.lower().to_vec(), rows.upper().to_vec())
        };
        let now = |rows: &Rows| (rows.lower().to_vec(), rows.upper().to_vec());
        let mut rows = Rows::equalities(&near, &[0.0, 1.0]).unwrap();
        for matrix in [&near, &near, &nearer, &far, &near] {
            rows.set_matrix(matrix).unwrap();
            for _ in 0..2 {
                damping.apply(&mut rows).unwrap();
                assert_eq!(now(&rows), fresh(&mut damping, matrix, [0.0, 1.0]));
            }
        }
        // One target of two is written.
        rows.lower_mut()[1] = 2.0;
        rows.upper_mut()[1] = 2.0;
        assert_eq!(now(&rows).0, [0.0, 2.0]);
        damping.apply(&mut rows).unwrap();
        assert_eq!(now(&rows), fresh(&mut damping, &near, [0.0, 2.0]));
        // Written anew, also with what came out of the damping, targets are targets.
        let reached = [rows.lower()[0], rows.lower()[1]];
        rows.set_targets(&reached).unwrap();
        damping.apply(&mut rows).unwrap();
        assert_eq!(now(&rows), fresh(&mut damping, &near, reached));
    }

    #[test]
    fn bad_input_is_an_error() {
        assert!(matches!(Damping::new(2, 0.0, 0.1), Err(Error::Value { .. })));
        assert!(matches!(Damping::new(2, 0.1, f64::NAN), Err(Error::Value { .. })));
        let mut damping = Damping::new(1, 0.1, 0.05).unwrap();
        assert!(matches!(damping.apply(&mut Rows::zeros(2, 3)), Err(Error::Size { .. })));
        let mut open = Rows::zeros(1, 3);
        open.upper_mut()[0] = 1.0;
        assert!(matches!(damping.apply(&mut open), Err(Error::Value { .. })));
        let mut nan = Rows::zeros(1, 3);
        nan.row_mut(0).unwrap()[1] = f64::NAN;
        assert!(matches!(damping.apply(&mut nan), Err(Error::Value { .. })));
    }
}
