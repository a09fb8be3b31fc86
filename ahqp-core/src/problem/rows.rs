//! Blocks of linear rows `lower ≤ A x ≤ upper`.

use nalgebra::{Dim, Matrix, RawStorage};

use crate::Error;

/// A block of `m` rows over `n` variables, `lower ≤ A x ≤ upper`.
///
/// Equal bounds make an equality, an infinite bound leaves its side free. As an objective the
/// violation of the rows is minimised in the least-squares sense; as constraints they hold.
///
/// ```
/// use ahqp_core::Rows;
/// use nalgebra::{dmatrix, dvector};
///
/// let rows = Rows::equalities(&dmatrix![1.0, 0.0; 0.0, 2.0], &dvector![3.0, 4.0])?;
/// assert_eq!(rows.len(), 2);
/// assert_eq!(rows.row(1), Some(&[0.0, 2.0][..]));
/// # Ok::<(), ahqp_core::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Rows {
    columns: usize,
    matrix: Vec<f64>,
    lower: Vec<f64>,
    upper: Vec<f64>,
}

impl Rows {
    /// `rows` zero rows over `columns` variables, every bound zero.
    pub fn zeros(rows: usize, columns: usize) -> Self {
        Self {
            columns,
            matrix: vec![0.0; rows * columns],
            lower: vec![0.0; rows],
            upper: vec![0.0; rows],
        }
    }

    /// `A x = b`, with `A` of size m × n and `b` of size m.
    ///
    /// # Errors
    /// [`Error::Size`] when `b` has not as many entries as `A` has rows.
    pub fn equalities<R: Dim, C: Dim, S, D: Dim, T>(
        a: &Matrix<f64, R, C, S>,
        b: &nalgebra::Vector<f64, D, T>,
    ) -> Result<Self, Error>
    where
        S: RawStorage<f64, R, C>,
        T: RawStorage<f64, D>,
    {
        Self::ranges(a, b, b)
    }

    /// `lower ≤ A x ≤ upper`, with `A` of size m × n and the bounds of size m.
    ///
    /// # Errors
    /// [`Error::Size`] when a bound has not as many entries as `A` has rows.
    pub fn ranges<R: Dim, C: Dim, S, D: Dim, T, E: Dim, U>(
        a: &Matrix<f64, R, C, S>,
        lower: &nalgebra::Vector<f64, D, T>,
        upper: &nalgebra::Vector<f64, E, U>,
    ) -> Result<Self, Error>
    where
        S: RawStorage<f64, R, C>,
        T: RawStorage<f64, D>,
        U: RawStorage<f64, E>,
    {
        let mut rows = Self::zeros(a.nrows(), a.ncols());
        rows.set_matrix(a)?;
        rows.set_bounds(lower, upper)?;
        Ok(rows)
    }

    /// How many rows there are.
    pub fn len(&self) -> usize {
        self.lower.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.lower.is_empty()
    }

    /// How many variables a row covers.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// The coefficients of row `index`, one a variable.
    pub fn row(&self, index: usize) -> Option<&[f64]> {
        self.matrix.get(index * self.columns..(index + 1) * self.columns)
    }

    /// The coefficients of row `index`, to write in place.
    pub fn row_mut(&mut self, index: usize) -> Option<&mut [f64]> {
        self.matrix.get_mut(index * self.columns..(index + 1) * self.columns)
    }

    /// The lower bounds.
    pub fn lower(&self) -> &[f64] {
        &self.lower
    }

    /// The lower bounds, to write in place.
    pub fn lower_mut(&mut self) -> &mut [f64] {
        &mut self.lower
    }

    /// The upper bounds.
    pub fn upper(&self) -> &[f64] {
        &self.upper
    }

    /// The upper bounds, to write in place.
    pub fn upper_mut(&mut self) -> &mut [f64] {
        &mut self.upper
    }

    /// Copies the coefficients from an m × n matrix.
    ///
    /// # Errors
    /// [`Error::Size`] when its size is not the block's.
    pub fn set_matrix<R: Dim, C: Dim, S: RawStorage<f64, R, C>>(
        &mut self,
        a: &Matrix<f64, R, C, S>,
    ) -> Result<(), Error> {
        expect_size("the rows of A", a.nrows(), self.len())?;
        expect_size("the columns of A", a.ncols(), self.columns)?;
        if self.columns > 0 {
            for (i, row) in self.matrix.chunks_exact_mut(self.columns).enumerate() {
                for (j, entry) in row.iter_mut().enumerate() {
                    *entry = a[(i, j)];
                }
            }
        }
        Ok(())
    }

    /// Copies the bounds.
    ///
    /// # Errors
    /// [`Error::Size`] when they have not one entry a row.
    pub fn set_bounds<D: Dim, T, E: Dim, U>(
        &mut self,
        lower: &nalgebra::Vector<f64, D, T>,
        upper: &nalgebra::Vector<f64, E, U>,
    ) -> Result<(), Error>
    where
        T: RawStorage<f64, D>,
        U: RawStorage<f64, E>,
    {
        expect_size("the lower bound", lower.nrows(), self.len())?;
        expect_size("the upper bound", upper.nrows(), self.len())?;
        self.lower.iter_mut().zip(lower.iter()).for_each(|(to, from)| *to = *from);
        self.upper.iter_mut().zip(upper.iter()).for_each(|(to, from)| *to = *from);
        Ok(())
    }

    /// A, row after row.
    pub(crate) fn coefficients(&self) -> &[f64] {
        &self.matrix
    }

    /// Every row with its bounds: `(coefficients, lower, upper)`.
    pub fn iter(&self) -> impl Iterator<Item = (&[f64], f64, f64)> + '_ {
        (0..self.len()).map(|i| {
            let row = &self.matrix[i * self.columns..(i + 1) * self.columns];
            (row, self.lower[i], self.upper[i])
        })
    }
}

/// An error unless `found` equals `expected`.
pub(crate) fn expect_size(what: &'static str, found: usize, expected: usize) -> Result<(), Error> {
    if found == expected { Ok(()) } else { Err(Error::Size { what, found, expected }) }
}
