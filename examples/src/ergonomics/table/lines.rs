//! Lines that are counted while they are read.

use std::io::{BufRead, Read, Result};

/// Hands out at most one line at a time, so that whoever reads knows in which one they are.
///
/// (The `csv` crate counts lines too, but names the line before for files with Windows line ends
/// and for rows after blank lines.)
#[derive(Debug)]
pub(super) struct Lines<R> {
    inner: R,
    line: usize,
    inside: bool,
}

impl<R: BufRead> Lines<R> {
    pub(super) fn new(inner: R) -> Self {
        Self { inner, line: 0, inside: false }
    }

    /// The line from which text was handed out last; the first is 1.
    pub(super) fn line(&self) -> usize {
        self.line
    }
}

impl<R: BufRead> Read for Lines<R> {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
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
        }
        self.inner.consume(count);
        Ok(count)
    }
}
