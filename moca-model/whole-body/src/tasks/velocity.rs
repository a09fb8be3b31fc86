//! Rows that the caller writes.

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

    /// Writes a row: the coefficients of q̇ (missing ones are zero), and its bounds, of which one
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
        if lower.is_nan() || upper.is_nan() || lower > upper || lower == f64::INFINITY {
            return Err(Error::RowRange { row, lower, upper });
        }
        let own = self.row(row)?;
        own.coefficients.clear();
        own.coefficients.extend_from_slice(coefficients);
        (own.lower, own.upper) = (lower, upper);
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

impl Task for VelocityTask {
    fn dimension(&self, _model: &Model) -> usize {
        self.rows.len()
    }

    fn is_damped(&self) -> bool {
        false
    }

    fn write(
        &mut self,
        input: &mut TaskInput<'_, '_>,
        rows: &mut TaskRows<'_>,
    ) -> Result<(), Error> {
        let size = input.posed().model().velocity_count();
        for (index, own) in self.rows.iter().enumerate() {
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
