//! Lines that are counted while they are read.

use std::io::{BufRead, Error, Read, Result};

/// Returns at most one line at a time, so that the reader knows the current line.
///
/// (The `csv` crate counts lines too, but names the wrong line for files with Windows line ends and
/// for rows after blank lines.)
#[derive(Debug)]
pub(super) struct Lines<R> {
    inner: R,
    line: usize,
    inside: bool,
    /// Bytes returned since the last complete row.
    row: usize,
}

/// Length of the longest row (bytes).
pub(super) const LONGEST_ROW: usize = 1 << 20;

impl<R: BufRead> Lines<R> {
    /// Creates a reader that returns the lines after the first `before`, which have been read.
    pub(super) fn new(inner: R, before: usize) -> Self {
        Self { inner, line: before, inside: false, row: 0 }
    }

    /// Returns the line of the last text, counted from 1.
    pub(super) fn line(&self) -> usize {
        self.line
    }

    /// Starts a new row.
    pub(super) fn begin_row(&mut self) {
        self.row = 0;
    }

    /// Returns true if the row is longer than allowed.
    pub(super) fn too_long(&self) -> bool {
        self.row > LONGEST_ROW
    }
}

impl<R: BufRead> Read for Lines<R> {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        if self.too_long() {
            return Err(Error::other("a row is too long"));
        }
        let available = self.inner.fill_buf()?;
        let end = available.iter().position(|byte| *byte == b'\n').map(|newline| newline + 1);
        let count = end.unwrap_or(available.len()).min(buffer.len());
        let (Some(to), Some(from)) = (buffer.get_mut(..count), available.get(..count)) else {
            return Ok(0);
        };
        to.copy_from_slice(from);
        if count > 0 {
            self.line += usize::from(!self.inside);
            self.inside = from.last() != Some(&b'\n');
            self.row += count;
        }
        self.inner.consume(count);
        Ok(count)
    }
}
