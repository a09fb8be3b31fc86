//! Numbers and texts of the caller.

use std::ffi::{CStr, c_char};

use ahqp_core::CoefficientMatrix;

use crate::failure::{AhqpStatus, Failure, Result};

/// Contiguous numbers to read. A null pointer stands for an absent vector where that is allowed.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct AhqpVector {
    /// Pointer to the first number.
    pub data: *const f64,
    /// Number of elements.
    pub size: usize,
}

/// Matrix to read, in any layout.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct AhqpMatrix {
    /// Pointer to the number in the first row and column.
    pub data: *const f64,
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
    /// Distance from one row to the next, in numbers: the number of columns if rows are contiguous.
    pub row_stride: usize,
    /// Distance from one column to the next, in numbers: 1 if rows are contiguous.
    pub column_stride: usize,
}

/// Largest number of entries. More would not fit into memory several times.
const MOST_ENTRIES: usize = 1 << 26;

impl AhqpVector {
    /// Returns the numbers, or `None` for a null pointer.
    ///
    /// # Safety
    /// `data`, if not null, points to `size` numbers that nobody writes while the result is in use.
    pub(crate) unsafe fn optional<'a>(self, what: &str, size: usize) -> Result<Option<&'a [f64]>> {
        if self.data.is_null() {
            return Ok(None);
        }
        if self.size != size {
            return Err(Failure::size(what, self.size, size));
        }
        if !self.data.is_aligned() {
            return Err(unaligned(what));
        }
        // SAFETY: not null and aligned; the caller promises the rest.
        Ok(Some(unsafe { std::slice::from_raw_parts(self.data, size) }))
    }

    /// Returns the numbers, or an error for a null pointer.
    ///
    /// # Safety
    /// See [`optional`](Self::optional).
    pub(crate) unsafe fn required<'a>(self, what: &str, size: usize) -> Result<&'a [f64]> {
        // SAFETY: the caller promises what is needed.
        unsafe { self.optional(what, size) }?.ok_or_else(|| Failure::null(what))
    }
}

fn unaligned(what: &str) -> Failure {
    Failure::new(AhqpStatus::BadArgument, &format_args!("{what} is not aligned to 8 bytes"))
}

/// Matrix whose pointer and sizes are checked.
#[derive(Debug)]
pub(crate) struct Matrix(AhqpMatrix);

impl AhqpMatrix {
    /// Returns the matrix, or `None` for a null pointer.
    ///
    /// # Safety
    /// `data`, if not null, points to numbers at all of the strides' multiples, which nobody writes while
    /// the result is in use.
    pub(crate) unsafe fn optional(self, what: &str) -> Result<Option<Matrix>> {
        let entries = self.rows.checked_mul(self.columns);
        if entries.is_none_or(|entries| entries > MOST_ENTRIES) {
            let (rows, columns) = (self.rows, self.columns);
            let text =
                format_args!("{what} is {rows} × {columns}, more than {MOST_ENTRIES} numbers");
            return Err(Failure::new(AhqpStatus::BadArgument, &text));
        }
        if !self.data.is_null() && !self.data.is_aligned() {
            return Err(unaligned(what));
        }
        if self.last_offset().is_none() {
            let text = format_args!("the strides of {what} reach beyond the memory that can be");
            return Err(Failure::new(AhqpStatus::BadArgument, &text));
        }
        Ok(if self.data.is_null() { None } else { Some(Matrix(self)) })
    }

    /// Returns the offset of the last number from the first \[bytes\]. Returns `None` if there is no valid offset, as
    /// for a negative stride.
    fn last_offset(&self) -> Option<isize> {
        let rows = self.rows.saturating_sub(1).checked_mul(self.row_stride)?;
        let columns = self.columns.saturating_sub(1).checked_mul(self.column_stride)?;
        let bytes = rows.checked_add(columns)?.checked_mul(size_of::<f64>())?;
        bytes.try_into().ok()
    }

    /// Returns the matrix, or an error for a null pointer.
    ///
    /// # Safety
    /// See [`optional`](Self::optional).
    pub(crate) unsafe fn required(self, what: &str) -> Result<Matrix> {
        // SAFETY: the caller promises what is needed.
        unsafe { self.optional(what) }?.ok_or_else(|| Failure::null(what))
    }
}

impl CoefficientMatrix for Matrix {
    fn nrows(&self) -> usize {
        self.0.rows
    }

    fn ncols(&self) -> usize {
        self.0.columns
    }

    fn entry(&self, row: usize, column: usize) -> f64 {
        assert!(row < self.0.rows && column < self.0.columns, "an entry of the matrix");
        let offset = row * self.0.row_stride + column * self.0.column_stride;
        // SAFETY: within rows and columns, where the caller of the interface promises numbers.
        unsafe { *self.0.data.add(offset) }
    }
}

/// Returns numbers to write.
///
/// # Safety
/// `data`, if not null, points to `size` numbers that nobody else uses while the result is in use.
pub(crate) unsafe fn output<'a>(
    what: &str,
    data: *mut f64,
    size: usize,
    expected: usize,
) -> Result<&'a mut [f64]> {
    if data.is_null() {
        return Err(Failure::null(what));
    }
    if size != expected {
        return Err(Failure::size(what, size, expected));
    }
    if !data.is_aligned() {
        return Err(unaligned(what));
    }
    // SAFETY: not null and aligned; the caller promises the rest.
    Ok(unsafe { std::slice::from_raw_parts_mut(data, size) })
}

/// Returns a text that ends with a zero byte, or `None` for a null pointer.
///
/// # Safety
/// `text`, if not null, points to bytes up to a zero byte that nobody writes while the result is in use.
pub(crate) unsafe fn optional_text<'a>(what: &str, text: *const c_char) -> Result<Option<&'a str>> {
    if text.is_null() {
        return Ok(None);
    }
    // SAFETY: not null; the caller promises the zero byte.
    let text = unsafe { CStr::from_ptr(text) };
    let wrong = |_| Failure::new(AhqpStatus::BadArgument, &format_args!("{what} is not UTF-8"));
    text.to_str().map(Some).map_err(wrong)
}

/// Returns a text, or an error for a null pointer.
///
/// # Safety
/// See [`optional_text`].
pub(crate) unsafe fn text<'a>(what: &str, text: *const c_char) -> Result<&'a str> {
    // SAFETY: the caller promises what is needed.
    unsafe { optional_text(what, text) }?.ok_or_else(|| Failure::null(what))
}
