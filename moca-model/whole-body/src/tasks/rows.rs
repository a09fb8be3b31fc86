//! Access to the rows of one task within its level.

use ahqp_core::Rows;
use nalgebra::Matrix6xX;

/// Access to the rows of one task, which are a part of the rows of its level.
///
/// Rows count from 0 within the task. Calls for other rows, or for variables that a row does not have, change nothing.
#[derive(Debug)]
pub struct TaskRows<'a> {
    rows: &'a mut Rows,
    weights: &'a mut [f64],
    first: usize,
    count: usize,
}

impl<'a> TaskRows<'a> {
    pub(crate) fn new(
        rows: &'a mut Rows,
        weights: &'a mut [f64],
        first: usize,
        count: usize,
    ) -> Self {
        Self { rows, weights, first, count }
    }

    /// Sets the rows to zero, with targets of zero and weights of one.
    pub(crate) fn clear(&mut self) {
        let own = self.first..self.first + self.count;
        self.rows.coefficients_mut(own.clone()).unwrap_or_default().fill(0.0);
        self.rows.lower_mut().get_mut(own.clone()).unwrap_or_default().fill(0.0);
        self.rows.upper_mut().get_mut(own.clone()).unwrap_or_default().fill(0.0);
        self.weights.get_mut(own).unwrap_or_default().fill(1.0);
    }

    /// The number of rows of the task.
    #[expect(clippy::len_without_is_empty, reason = "a task without rows is refused")]
    pub fn len(&self) -> usize {
        self.count
    }

    /// The coefficients of a row: those of q̇, then those of further variables.
    pub fn row_mut(&mut self, row: usize) -> &mut [f64] {
        let index = if row < self.count { self.first + row } else { usize::MAX };
        self.rows.row_mut(index).unwrap_or_default()
    }

    /// Writes the first coefficients of a row, which are those of q̇ in order.
    pub fn set_coefficients<'b>(
        &mut self,
        row: usize,
        coefficients: impl IntoIterator<Item = &'b f64>,
    ) {
        let own = self.row_mut(row).iter_mut();
        own.zip(coefficients).for_each(|(own, coefficient)| *own = *coefficient);
    }

    /// Copies the bounds and weights of all rows, and the first coefficients of as many rows as the matrix has.
    pub(crate) fn copy_from(
        &mut self,
        matrix: &[f64],
        columns: usize,
        bounds: [&[f64]; 2],
        weights: &[f64],
    ) {
        let (first, count) = (self.first, self.count);
        if columns == self.rows.columns() {
            let own = self.rows.coefficients_mut(first..first + count).unwrap_or_default();
            own.iter_mut().zip(matrix).for_each(|(own, coefficient)| *own = *coefficient);
        } else {
            for (row, coefficients) in matrix.chunks_exact(columns.max(1)).enumerate() {
                let own = self.row_mut(row);
                if let Some(own) = own.get_mut(..coefficients.len()) {
                    own.copy_from_slice(coefficients);
                }
            }
        }
        for (to, from) in [(self.rows.lower_mut(), bounds[0]), (&mut *self.weights, weights)] {
            to.iter_mut().skip(first).take(count).zip(from).for_each(|(to, from)| *to = *from);
        }
        let upper = self.rows.upper_mut().iter_mut().skip(first).take(count);
        upper.zip(bounds[1]).for_each(|(to, from)| *to = *from);
    }

    /// Writes a row of a Jacobian, which is stored by columns.
    pub(crate) fn set_jacobian_row(&mut self, row: usize, jacobian: &Matrix6xX<f64>, axis: usize) {
        let columns = jacobian.as_slice().as_chunks::<6>().0;
        for (own, column) in self.row_mut(row).iter_mut().zip(columns) {
            *own = column[axis];
        }
    }

    /// Sets a row to the equality `a q̇ = target`.
    pub fn set_target(&mut self, row: usize, target: f64) {
        self.set_range(row, target, target);
    }

    /// Sets a row to `lower ≤ a q̇ ≤ upper`; either bound may be infinite.
    pub fn set_range(&mut self, row: usize, lower: f64, upper: f64) {
        if row < self.count {
            let index = self.first + row;
            if let Some(bound) = self.rows.lower_mut().get_mut(index) {
                *bound = lower;
            }
            if let Some(bound) = self.rows.upper_mut().get_mut(index) {
                *bound = upper;
            }
        }
    }

    /// The bounds of a row as written so far, `(lower, upper)`.
    pub fn range(&self, row: usize) -> Option<(f64, f64)> {
        let index = if row < self.count { self.first + row } else { usize::MAX };
        Some((*self.rows.lower().get(index)?, *self.rows.upper().get(index)?))
    }

    /// Sets the weight of a row relative to the other rows of its level: from 1e-100 to 1e100, or zero to leave it out.
    pub fn set_weight(&mut self, row: usize, weight: f64) {
        if row < self.count
            && let Some(own) = self.weights.get_mut(self.first + row)
        {
            *own = weight;
        }
    }
}
