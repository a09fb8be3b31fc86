//! The task of rows that the caller writes.

use super::input::TaskInput;
use super::mask::check_weights;
use super::rows::TaskRows;
use super::task::{Limit, Task};
use crate::error::{Error, check_finite, check_size};
use crate::robot::model::Model;

/// Rows `lower ≤ a q̇ ≤ upper` that the caller writes. They hold until they are written again. Examples are equalities
/// of velocities, distances to obstacles, and rows from another program. A [`RowBlock`](super::RowBlock) has its rows in
/// the problem's data instead.
///
/// Rows that were not written bound nothing.
///
/// ```
/// use whole_body::tasks::VelocityTask;
///
/// // Room for two rows; q̇₀ + q̇₁ = 0.3 rad/s is the first.
/// let mut task = VelocityTask::new(2);
/// task.set_row(0, &[1.0, 1.0], 0.3, 0.3)?;
/// # Ok::<(), whole_body::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct VelocityTask {
    /// Coefficients by rows, with as many columns as the longest row that was written.
    matrix: Vec<f64>,
    columns: usize,
    lower: Vec<f64>,
    upper: Vec<f64>,
    weights: Vec<f64>,
}

impl VelocityTask {
    /// Creates a task with room for `rows` rows.
    pub fn new(rows: usize) -> Self {
        Self {
            matrix: Vec::new(),
            columns: 0,
            lower: vec![f64::NEG_INFINITY; rows],
            upper: vec![f64::INFINITY; rows],
            weights: vec![1.0; rows],
        }
    }

    /// Writes a row: the coefficients of q̇ and of further variables (missing ones are zero), and its bounds. One or
    /// both bounds may be infinite. Allocates only the first time.
    ///
    /// # Errors
    /// [`Error::Size`] for a row that does not exist, [`Error::Value`], also for bounds that are not in
    /// order. The row is then unchanged.
    pub fn set_row(
        &mut self,
        row: usize,
        coefficients: &[f64],
        lower: f64,
        upper: f64,
    ) -> Result<(), Error> {
        for value in coefficients {
            check_finite(*value, || format!("a coefficient of row {row}"))?;
        }
        check_range(row, lower, upper)?;
        self.expect_row(row)?;
        self.widen(coefficients.len());
        if let Some(own) = self.matrix.chunks_exact_mut(self.columns.max(1)).nth(row) {
            own.fill(0.0);
            own[..coefficients.len()].copy_from_slice(coefficients);
        }
        (self.lower[row], self.upper[row]) = (lower, upper);
        Ok(())
    }

    /// Sets other bounds of a row.
    ///
    /// # Errors
    /// As [`set_row`](Self::set_row).
    pub fn set_range(&mut self, row: usize, lower: f64, upper: f64) -> Result<(), Error> {
        check_range(row, lower, upper)?;
        self.expect_row(row)?;
        (self.lower[row], self.upper[row]) = (lower, upper);
        Ok(())
    }

    /// Sets the weight of a row relative to the other rows of the level. It has no effect on a hard limit.
    ///
    /// # Errors
    /// [`Error::Size`] for a row that does not exist, [`Error::Value`] for a weight out of range.
    pub fn set_weight(&mut self, row: usize, weight: f64) -> Result<(), Error> {
        check_weights(&[weight])?;
        self.expect_row(row)?;
        self.weights[row] = weight;
        Ok(())
    }

    fn expect_row(&self, row: usize) -> Result<(), Error> {
        let (what, wanted) = ("the list of rows up to this one", self.lower.len());
        if row < wanted { Ok(()) } else { Err(Error::Size { what, got: row + 1, wanted }) }
    }

    /// Makes room for longer rows.
    fn widen(&mut self, columns: usize) {
        if columns > self.columns {
            let mut matrix = vec![0.0; self.lower.len() * columns];
            let old = self.matrix.chunks_exact(self.columns.max(1));
            for (new, old) in matrix.chunks_exact_mut(columns).zip(old) {
                new[..old.len()].copy_from_slice(old);
            }
            (self.matrix, self.columns) = (matrix, columns);
        }
    }
}

/// Returns an error unless the bounds are in order.
fn check_range(row: usize, lower: f64, upper: f64) -> Result<(), Error> {
    if lower.is_nan() || lower == f64::INFINITY {
        let (what, wanted) =
            (format!("the lower bound of row {row}"), "below its upper bound, or minus infinity");
        return Err(Error::value(what, lower, wanted));
    }
    if upper.is_nan() || lower > upper {
        let what = format!("the upper bound of row {row}");
        let wanted = format!("at least its lower bound {lower}, or infinity");
        return Err(Error::value(what, upper, wanted));
    }
    Ok(())
}

impl Task for VelocityTask {
    fn dimension(&self, _model: &Model) -> usize {
        self.lower.len()
    }

    fn is_damped(&self) -> bool {
        false
    }

    fn writes_all(&self, variables: usize) -> bool {
        self.columns == variables
    }

    fn write(
        &mut self,
        _input: &mut TaskInput<'_, '_>,
        rows: &mut TaskRows<'_>,
    ) -> Result<(), Error> {
        let size = rows.row_mut(0).len();
        if self.columns > size {
            check_size("a row", self.columns, size)?;
        }
        rows.copy_from(&self.matrix, self.columns, [&self.lower, &self.upper], &self.weights);
        Ok(())
    }
}

/// Rows that do not admit rest are widened until they do.
impl Limit for VelocityTask {}
