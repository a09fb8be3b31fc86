//! Blocks of linear rows `lower ≤ A x ≤ upper`.

use std::ops::{Range, RangeInclusive};
use std::sync::Arc;

use crate::error::Error;
use crate::linalg::kernels::multiply_rows;
use crate::problem::matrix::CoefficientMatrix;

/// Range of nonzero weights.
const WEIGHTS: RangeInclusive<f64> = 1e-100..=1e100;

/// A sequence of numbers: a slice, or a reference to an array, a `Vec`, an nalgebra vector or a
/// view of one.
pub trait Values<'a>: IntoIterator<Item = &'a f64, IntoIter: ExactSizeIterator> {}

impl<'a, T: IntoIterator<Item = &'a f64, IntoIter: ExactSizeIterator>> Values<'a> for T {}

/// A block of `m` rows over `n` variables, `lower ≤ A x ≤ upper`.
///
/// Equal bounds make an equality, and an infinite bound leaves its side free. In an objective the
/// violation of the rows is minimised in the least-squares sense. As constraints the rows hold.
///
/// ```
/// use ahqp_core::Rows;
/// use nalgebra::{dmatrix, dvector};
///
/// // x = 3 and 2 y = 4, the second with a hundredfold weight.
/// let mut rows = Rows::equalities(&dmatrix![1.0, 0.0; 0.0, 2.0], &dvector![3.0, 4.0])?
///     .with_names(["left", "right"])?;
/// rows.set_weights(&[1.0, 100.0])?;
/// assert_eq!((rows.len(), rows.row(1)), (2, Some(&[0.0, 2.0][..])));
///
/// // Rewritten in place, tick by tick.
/// rows.set_targets(&[3.5, 4.5])?;
/// rows.row_mut(0)?.copy_from_slice(&[1.0, 0.1]);
/// assert_eq!(rows.lower(), rows.upper());
///
/// // x + y ≤ 1.
/// let limit = Rows::at_most(&dmatrix![1.0, 1.0], &[1.0])?;
/// assert_eq!(limit.lower(), [f64::NEG_INFINITY]);
/// # Ok::<(), ahqp_core::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Rows {
    columns: usize,
    matrix: Vec<f64>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    /// One weight for each row, or empty.
    weights: Vec<f64>,
    /// True if any weight is not 1.
    is_weighted: bool,
    /// One name for each row, or empty.
    names: Vec<Arc<str>>,
}

impl Rows {
    /// Creates `rows` zero rows over `columns` variables, with all bounds zero.
    pub fn zeros(rows: usize, columns: usize) -> Self {
        Self {
            columns,
            matrix: vec![0.0; rows * columns],
            lower: vec![0.0; rows],
            upper: vec![0.0; rows],
            weights: Vec::new(),
            is_weighted: false,
            names: Vec::new(),
        }
    }

    /// Creates `A x = b`, with `A` of size m × n and `b` of size m.
    ///
    /// # Errors
    /// [`Error::Size`] if `b` has not as many entries as `A` has rows.
    pub fn equalities<'a>(a: &impl CoefficientMatrix, b: impl Values<'a>) -> Result<Self, Error> {
        let mut rows = Self::free(a)?;
        rows.set_targets(b)?;
        Ok(rows)
    }

    /// Creates `lower ≤ A x ≤ upper`, with `A` of size m × n and the bounds of size m.
    ///
    /// # Errors
    /// [`Error::Size`] if a bound has not as many entries as `A` has rows.
    pub fn ranges<'a>(
        a: &impl CoefficientMatrix,
        lower: impl Values<'a>,
        upper: impl Values<'a>,
    ) -> Result<Self, Error> {
        let mut rows = Self::free(a)?;
        rows.set_bounds(lower, upper)?;
        Ok(rows)
    }

    /// Creates `A x ≤ upper`, with `A` of size m × n and the bound of size m.
    ///
    /// # Errors
    /// [`Error::Size`] if the bound has not as many entries as `A` has rows.
    pub fn at_most<'a>(a: &impl CoefficientMatrix, upper: impl Values<'a>) -> Result<Self, Error> {
        let (mut rows, upper) = (Self::free(a)?, upper.into_iter());
        expect_size("the upper bound", upper.len(), rows.len())?;
        write(&mut rows.upper, upper);
        Ok(rows)
    }

    /// Creates `A x ≥ lower`, with `A` of size m × n and the bound of size m.
    ///
    /// # Errors
    /// [`Error::Size`] if the bound has not as many entries as `A` has rows.
    pub fn at_least<'a>(a: &impl CoefficientMatrix, lower: impl Values<'a>) -> Result<Self, Error> {
        let (mut rows, lower) = (Self::free(a)?, lower.into_iter());
        expect_size("the lower bound", lower.len(), rows.len())?;
        write(&mut rows.lower, lower);
        Ok(rows)
    }

    /// Creates `lower ≤ A x ≤ upper` from the coefficients of A, m × n = `rows` × `columns`, row by
    /// row. The bounds have size m.
    ///
    /// # Errors
    /// [`Error::Size`] if an argument has another size.
    pub fn from_row_slice<'a>(
        rows: usize,
        columns: usize,
        coefficients: &[f64],
        lower: impl Values<'a>,
        upper: impl Values<'a>,
    ) -> Result<Self, Error> {
        expect_size("the slice of coefficients", coefficients.len(), rows * columns)?;
        let mut block = Self::zeros(rows, columns);
        block.matrix.copy_from_slice(coefficients);
        block.set_bounds(lower, upper)?;
        Ok(block)
    }

    /// Creates the rows of A without bounds.
    fn free(a: &impl CoefficientMatrix) -> Result<Self, Error> {
        let mut rows = Self::zeros(a.nrows(), a.ncols());
        rows.set_matrix(a)?;
        rows.set_free();
        Ok(rows)
    }

    /// Names each row, for errors and conflicts.
    ///
    /// # Errors
    /// [`Error::Size`] unless there is one name for each row.
    pub fn with_names<T: Into<Arc<str>>>(
        mut self,
        names: impl IntoIterator<Item = T>,
    ) -> Result<Self, Error> {
        self.names = collect_names("the names of the rows", names, self.len())?;
        Ok(self)
    }

    /// Names of the rows, empty if they have none.
    pub fn names(&self) -> &[Arc<str>] {
        &self.names
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.lower.len()
    }

    /// Returns true if there are no rows.
    pub fn is_empty(&self) -> bool {
        self.lower.is_empty()
    }

    /// Number of variables, the columns of A.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Coefficients of row `index`, one for each variable.
    pub fn row(&self, index: usize) -> Option<&[f64]> {
        if index >= self.len() {
            return None;
        }
        self.matrix.get(index * self.columns..(index + 1) * self.columns)
    }

    /// Coefficients of row `index`, to write in place.
    ///
    /// # Errors
    /// [`Error::Size`] if `index` is past the last row.
    pub fn row_mut(&mut self, index: usize) -> Result<&mut [f64], Error> {
        let rows = self.len();
        if index >= rows {
            return Err(too_few(rows, index + 1));
        }
        Ok(&mut self.matrix[index * self.columns..(index + 1) * self.columns])
    }

    /// Coefficients of a range of rows, row by row, to write in place.
    ///
    /// # Errors
    /// [`Error::Size`] if the range ends past the last row.
    pub fn coefficients_mut(&mut self, rows: Range<usize>) -> Result<&mut [f64], Error> {
        let (last, count) = (rows.end, self.len());
        let own = rows.start * self.columns..rows.end * self.columns;
        self.matrix.get_mut(own).ok_or(too_few(count, last))
    }

    /// Sets coefficients and bounds of row `index`.
    ///
    /// # Errors
    /// [`Error::Size`] if `index` is past the last row, or unless there is one coefficient for each
    /// variable.
    pub fn set_row<'a>(
        &mut self,
        index: usize,
        coefficients: impl Values<'a>,
        lower: f64,
        upper: f64,
    ) -> Result<(), Error> {
        let coefficients = coefficients.into_iter();
        expect_size("a row", coefficients.len(), self.columns)?;
        write(self.row_mut(index)?, coefficients);
        (self.lower[index], self.upper[index]) = (lower, upper);
        Ok(())
    }

    /// The lower bounds, one for each row. Negative infinity stands for none.
    pub fn lower(&self) -> &[f64] {
        &self.lower
    }

    /// The lower bounds, to write in place.
    pub fn lower_mut(&mut self) -> &mut [f64] {
        &mut self.lower
    }

    /// The upper bounds, one for each row. Infinity stands for none.
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
    /// [`Error::Size`] if its size is not that of the block.
    pub fn set_matrix(&mut self, a: &impl CoefficientMatrix) -> Result<(), Error> {
        expect_size("the rows of A", a.nrows(), self.len())?;
        expect_size("the columns of A", a.ncols(), self.columns)?;
        if self.columns > 0 {
            for (i, row) in self.matrix.chunks_exact_mut(self.columns).enumerate() {
                for (j, entry) in row.iter_mut().enumerate() {
                    *entry = a.entry(i, j);
                }
            }
        }
        Ok(())
    }

    /// Copies the bounds.
    ///
    /// # Errors
    /// [`Error::Size`] unless there is one entry for each row. The rows are then unchanged.
    pub fn set_bounds<'a>(
        &mut self,
        lower: impl Values<'a>,
        upper: impl Values<'a>,
    ) -> Result<(), Error> {
        let (lower, upper) = (lower.into_iter(), upper.into_iter());
        expect_size("the lower bound", lower.len(), self.len())?;
        expect_size("the upper bound", upper.len(), self.len())?;
        write(&mut self.lower, lower);
        write(&mut self.upper, upper);
        Ok(())
    }

    /// Makes the rows equalities with these targets, by setting both bounds.
    ///
    /// # Errors
    /// [`Error::Size`] unless there is one target for each row. The rows are then unchanged.
    pub fn set_targets<'a>(&mut self, targets: impl Values<'a>) -> Result<(), Error> {
        let targets = targets.into_iter();
        expect_size("the targets", targets.len(), self.len())?;
        write(&mut self.lower, targets);
        self.upper.copy_from_slice(&self.lower);
        Ok(())
    }

    /// Removes all bounds.
    pub fn set_free(&mut self) {
        self.lower.fill(f64::NEG_INFINITY);
        self.upper.fill(f64::INFINITY);
    }

    /// Sets the weights wᵢ of the rows of an objective, which minimises ½ Σ wᵢ dᵢ². dᵢ is the
    /// distance of row i to its range.
    ///
    /// A weight of 100 has the effect of multiplying the row and its bounds by ten. A weight of
    /// zero leaves the row out. Rows without weights have weight 1. Setting weights again replaces
    /// them. Weights have no influence between levels, and none on hard constraints. The first call
    /// allocates, later calls do not.
    ///
    /// # Errors
    /// [`Error::Size`] unless there is one weight for each row. [`Error::Value`] unless each is
    /// zero or from 1e-100 to 1e100. The rows are then unchanged.
    pub fn set_weights<'a, T: Values<'a, IntoIter: Clone>>(
        &mut self,
        weights: T,
    ) -> Result<(), Error> {
        let weights = weights.into_iter();
        expect_size("the weights", weights.len(), self.len())?;
        let fits = |weight: &f64| *weight == 0.0 || WEIGHTS.contains(weight);
        if let Some((row, &weight)) = weights.clone().enumerate().find(|(_, w)| !fits(w)) {
            let wanted = "from 1e-100 to 1e100, or zero to leave the row out";
            return Err(Error::Value {
                what: "the weight of row",
                index: Some(row),
                got: weight,
                wanted,
            });
        }
        self.weights.resize(self.len(), 1.0);
        write(&mut self.weights, weights);
        self.is_weighted = self.weights.iter().any(|weight| *weight != 1.0);
        Ok(())
    }

    /// Weight of row `index`, 1 unless one was set.
    pub fn weight(&self, index: usize) -> f64 {
        self.weights.get(index).copied().unwrap_or(1.0)
    }

    /// Weights of the rows. None if all are 1.
    pub fn weights(&self) -> Option<&[f64]> {
        self.is_weighted.then_some(&self.weights)
    }

    /// Copies coefficients, bounds and weights from rows of the same size. The names stay.
    /// Allocates only if these are the first weights.
    ///
    /// # Errors
    /// [`Error::Size`] if the sizes differ. The rows are then unchanged.
    pub fn copy_from(&mut self, other: &Self) -> Result<(), Error> {
        expect_size("the block to copy", other.len(), self.len())?;
        expect_size("a row to copy", other.columns, self.columns)?;
        self.matrix.copy_from_slice(&other.matrix);
        self.lower.copy_from_slice(&other.lower);
        self.upper.copy_from_slice(&other.upper);
        self.weights.clear();
        self.weights.extend_from_slice(&other.weights);
        self.is_weighted = other.is_weighted;
        Ok(())
    }

    /// Writes the products aᵢx of the rows from `first` on, one for each entry of `out`. x contains
    /// the first variables, and the others are zero. Uses the machine's vector unit, and allocates
    /// nothing.
    ///
    /// ```
    /// use ahqp_core::Rows;
    /// use nalgebra::dmatrix;
    ///
    /// let rows = Rows::at_most(&dmatrix![1.0, 2.0; 3.0, 4.0], &[1.0, 1.0])?;
    /// let mut values = [0.0; 2];
    /// rows.multiply_into(0, &[1.0, 10.0], &mut values)?;
    /// assert_eq!(values, [21.0, 43.0]);
    /// # Ok::<(), ahqp_core::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Size`] if there are fewer rows or fewer variables.
    pub fn multiply_into(&self, first: usize, x: &[f64], out: &mut [f64]) -> Result<(), Error> {
        if first + out.len() > self.len() {
            let got = first + out.len();
            return Err(Error::Size { what: "the rows to multiply", got, wanted: self.len() });
        }
        if x.len() > self.columns {
            return Err(Error::Size { what: "the variables", got: x.len(), wanted: self.columns });
        }
        if self.columns > 0 {
            multiply_rows(&self.matrix[first * self.columns..], self.columns, x, out);
        }
        Ok(())
    }

    /// Coefficients of A, row by row.
    pub fn coefficients(&self) -> &[f64] {
        &self.matrix
    }

    /// Iterates over the rows with their bounds, without weights: `(coefficients, lower, upper)`.
    pub fn iter(&self) -> impl Iterator<Item = (&[f64], f64, f64)> + '_ {
        (0..self.len()).map(|i| {
            let row = &self.matrix[i * self.columns..(i + 1) * self.columns];
            (row, self.lower[i], self.upper[i])
        })
    }
}

/// Creates the error for a row past the last.
fn too_few(got: usize, wanted: usize) -> Error {
    Error::Size { what: "the block with the row asked for", got, wanted }
}

/// Returns an error unless the size is the expected one.
pub(crate) fn expect_size(what: &'static str, got: usize, wanted: usize) -> Result<(), Error> {
    if got == wanted { Ok(()) } else { Err(Error::Size { what, got, wanted }) }
}

/// Copies numbers until either side ends.
pub(crate) fn write<'a>(to: &mut [f64], from: impl Iterator<Item = &'a f64>) {
    to.iter_mut().zip(from).for_each(|(to, from)| *to = *from);
}

/// Collects names, of which there must be as many as `expected`.
pub(crate) fn collect_names<T: Into<Arc<str>>>(
    what: &'static str,
    names: impl IntoIterator<Item = T>,
    expected: usize,
) -> Result<Vec<Arc<str>>, Error> {
    let names: Vec<Arc<str>> = names.into_iter().map(Into::into).collect();
    expect_size(what, names.len(), expected)?;
    Ok(names)
}
