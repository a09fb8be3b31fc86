//! The lines of a text, read in bounded memory.

use std::io::{BufRead, Read};

use crate::error::RecordingError;

/// The byte-order mark that some editors write before a text.
const MARK: &[u8] = "\u{feff}".as_bytes();

/// Largest length of a line (bytes).
const LONGEST_LINE: usize = 64 * 1024;

/// A line that is not blank.
#[derive(Debug)]
pub(super) struct Line<'a> {
    /// Number, from 1.
    pub(super) number: usize,
    /// Text, trimmed.
    pub(super) text: &'a [u8],
    /// True if its end was found. Only the last line of a text can lack it.
    pub(super) terminated: bool,
}

/// The non-blank lines of the input, of bounded length, with their numbers.
#[derive(Debug)]
pub(super) struct Lines<R> {
    input: R,
    buffer: Vec<u8>,
    number: usize,
}

impl<R: BufRead> Lines<R> {
    pub(super) fn new(input: R) -> Self {
        Self { input, buffer: Vec::new(), number: 0 }
    }

    /// Returns the number of lines that were read, including blank ones.
    pub(super) fn count(&self) -> usize {
        self.number
    }

    /// Returns the next non-blank line. A byte-order mark before the first line is removed.
    pub(super) fn next(&mut self) -> Result<Option<Line<'_>>, RecordingError> {
        loop {
            self.buffer.clear();
            let number = self.number + 1;
            let read = self
                .input
                .by_ref()
                .take(LONGEST_LINE as u64 + 1)
                .read_until(b'\n', &mut self.buffer)
                .map_err(|source| RecordingError::Io { line: number, source })?;
            if read == 0 {
                return Ok(None);
            }
            if read > LONGEST_LINE {
                return Err(RecordingError::LineTooLong { line: number, limit: LONGEST_LINE });
            }
            self.number = number;
            if number == 1 && self.buffer.starts_with(MARK) {
                self.buffer.drain(..MARK.len());
            }
            if !self.buffer.trim_ascii().is_empty() {
                let terminated = self.buffer.ends_with(b"\n");
                let text = self.buffer.trim_ascii();
                return Ok(Some(Line { number, text, terminated }));
            }
        }
    }
}
