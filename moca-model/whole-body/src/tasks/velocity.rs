//! Rows that the caller writes.

use ahqp_core::Rows;

use super::input::TaskInput;
use super::mask::check_weights;
use super::rows::TaskRows;
use super::task::{Limit, Task};
use crate::error::{Error, check_finite, check_size};
use crate::robot::model::Model;

/// Rows `lower ≤ a q̇ ≤ upper` that the caller writes, for as long as they are not written anew:
/// equalities at velocity level, distances to obstacles, what another program computes.
///
/// Rows that were not written bound nothing.
///
/// ```
/// use whole_body::VelocityTask;
///
/// // Room for two rows; q̇₀ + q̇₁ = 0.3 rad/s is the first.
/// let mut task = VelocityTask::new(2);
/// task.set_row(0, &[1.0, 1.0], 0.3, 0.3)?;
/// task.clear_row(1)?;
/// # Ok::<(), whole_body::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct VelocityTask {
    rows: Vec<OwnRow>,
}

#[derive(Debug, Clone)]
struct OwnRow {
    coefficients: Vec<f64>,
    lower: f64,
    upper: f64,
    weight: f64,
}

impl VelocityTask {
    /// With room for so many rows.
    pub fn new(rows: usize) -> Self {
        let free = OwnRow {
            coefficients: Vec::new(),
            lower: f64::NEG_INFINITY,
            upper: f64::INFINITY,
            weight: 1.0,
        };
        Self { rows: vec![free; rows] }
    }

    /// With these rows, to be [copied](Self::copy_from) over later.
    pub fn from_rows(rows: &Rows) -> Self {
        let own = rows.iter().enumerate().map(|(index, (row, lower, upper))| OwnRow {
            coefficients: row.to_vec(),
            lower,
            upper,
            weight: rows.weight(index),
        });
        Self { rows: own.collect() }
    }

    /// Writes a row: the coefficients of q̇ and of further variables behind it (missing ones are
    /// zero), and its bounds, of which one
    /// or both may be infinite. Allocates only the first time.
    ///
    /// # Errors
    /// [`Error::WrongSize`] for a row past the last, [`Error::NotFinite`], [`Error::RowRange`] for
    /// bounds that leave nothing between them. The row is then as before.
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
        let own = self.row(row)?;
        own.coefficients.clear();
        own.coefficients.extend_from_slice(coefficients);
        (own.lower, own.upper) = (lower, upper);
        Ok(())
    }

    /// Other bounds of a row.
    ///
    /// # Errors
    /// As [`set_row`](Self::set_row).
    pub fn set_range(&mut self, row: usize, lower: f64, upper: f64) -> Result<(), Error> {
        check_range(row, lower, upper)?;
        let own = self.row(row)?;
        (own.lower, own.upper) = (lower, upper);
        Ok(())
    }

    /// Takes all rows, with their bounds and weights, from those of another crate, such as the
    /// distances of `hrsw`. Allocates only where it had none of that size.
    ///
    /// # Errors
    /// [`Error::WrongSize`] unless there are as many; what is not finite is an error of the step.
    pub fn copy_from(&mut self, rows: &Rows) -> Result<(), Error> {
        check_size("the rows to copy", rows.len(), self.rows.len())?;
        for (index, (own, (row, lower, upper))) in self.rows.iter_mut().zip(rows.iter()).enumerate()
        {
            own.coefficients.clear();
            own.coefficients.extend_from_slice(row);
            (own.lower, own.upper, own.weight) = (lower, upper, rows.weight(index));
        }
        Ok(())
    }

    /// Lets a row bound nothing.
    ///
    /// # Errors
    /// [`Error::WrongSize`] for a row past the last.
    pub fn clear_row(&mut self, row: usize) -> Result<(), Error> {
        let own = self.row(row)?;
        own.coefficients.clear();
        (own.lower, own.upper) = (f64::NEG_INFINITY, f64::INFINITY);
        Ok(())
    }

    /// What a row weighs against the other rows of the level; nothing for a hard limit.
    ///
    /// # Errors
    /// [`Error::WrongSize`] for a row past the last, [`Error::Parameter`] for a bad weight.
    pub fn set_weight(&mut self, row: usize, weight: f64) -> Result<(), Error> {
        check_weights(&[weight])?;
        self.row(row)?.weight = weight;
        Ok(())
    }

    fn row(&mut self, row: usize) -> Result<&mut OwnRow, Error> {
        let expected = self.rows.len();
        let what = "the list of rows up to this one";
        self.rows.get_mut(row).ok_or(Error::WrongSize { what, expected, got: row + 1 })
    }
}

/// An error unless the bounds leave something between them.
fn check_range(row: usize, lower: f64, upper: f64) -> Result<(), Error> {
    if lower.is_nan() || upper.is_nan() || lower > upper || lower == f64::INFINITY {
        return Err(Error::RowRange { row, lower, upper });
    }
    Ok(())
}

impl Task for VelocityTask {
    fn dimension(&self, _model: &Model) -> usize {
        self.rows.len()
    }

    fn is_damped(&self) -> bool {
        false
    }

    fn write(
        &mut self,
        _input: &mut TaskInput<'_, '_>,
        rows: &mut TaskRows<'_>,
    ) -> Result<(), Error> {
        for (index, own) in self.rows.iter().enumerate() {
            let size = rows.row_mut(index).len();
            if own.coefficients.len() > size {
                check_size("a row", own.coefficients.len(), size)?;
            }
            rows.set_coefficients(index, &own.coefficients);
            rows.set_range(index, own.lower, own.upper);
            rows.set_weight(index, own.weight);
        }
        Ok(())
    }
}

/// Rows that do not admit rest are widened until they do.
impl Limit for VelocityTask {}
