//! The lines of a text, in bounded memory.

use std::io::{BufRead, Read};

use crate::error::RecordingError;

/// The byte-order mark that some editors put before a text.
const MARK: &[u8] = "\u{feff}".as_bytes();

/// The most that is read of one line (bytes).
const LONGEST_LINE: usize = 64 * 1024;

/// A line that is not blank.
#[derive(Debug)]
pub(super) struct Line<'a> {
    /// From 1.
    pub(super) number: usize,
    /// Without white space around it.
    pub(super) text: &'a [u8],
    /// Whether its end was found; only the last line of a text can be without.
    pub(super) terminated: bool,
}

/// The lines of the input that are not blank, of bounded length, with their numbers.
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

    /// How many lines were read, blank ones included.
    pub(super) fn count(&self) -> usize {
        self.number
    }

    /// The next line that is not blank, without a byte-order mark before the first.
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
