//! Reads a part of a file and checks every length against the remaining one.

use std::io::{BufRead, BufReader, Read, Seek, SeekFrom};

use super::error::{beyond, truncated};
use crate::error::Error;

/// Longest line (bytes). No name of a module or class is longer.
const LONGEST_LINE: usize = 4096;

/// A part of a file that is read from beginning to end.
pub(super) struct Input<R> {
    reader: R,
    position: u64,
    remaining: u64,
}

impl<'a, R: Read + Seek> Input<BufReader<&'a mut R>> {
    /// Opens `size` bytes at `position` of a file of `length` bytes.
    pub(super) fn open(
        source: &'a mut R,
        position: u64,
        size: u64,
        length: u64,
    ) -> Result<Self, Error> {
        let available = length.saturating_sub(position);
        if size > available {
            let what = "part of the file";
            return Err(truncated(what, position, size, available));
        }
        source.seek(SeekFrom::Start(position)).map_err(|error| reading(&error))?;
        Ok(Self::new(BufReader::new(source), position, size))
    }
}

impl<R: BufRead> Input<R> {
    /// Creates the input of the reader's next `length` bytes. `position` is their position for
    /// errors.
    pub(super) fn new(reader: R, position: u64, length: u64) -> Self {
        Self { reader, position, remaining: length }
    }

    pub(super) fn position(&self) -> u64 {
        self.position
    }

    pub(super) fn remaining(&self) -> u64 {
        self.remaining
    }

    pub(super) fn array<const SIZE: usize>(
        &mut self,
        what: &'static str,
    ) -> Result<[u8; SIZE], Error> {
        self.claim(SIZE as u64, what)?;
        let mut bytes = [0; SIZE];
        self.reader.read_exact(&mut bytes).map_err(|error| reading(&error))?;
        Ok(bytes)
    }

    pub(super) fn byte(&mut self, what: &'static str) -> Result<u8, Error> {
        let [byte] = self.array(what)?;
        Ok(byte)
    }

    pub(super) fn bytes(&mut self, length: u64, what: &'static str) -> Result<Vec<u8>, Error> {
        let mut bytes = vec![0; self.claim(length, what)?];
        self.reader.read_exact(&mut bytes).map_err(|error| reading(&error))?;
        Ok(bytes)
    }

    pub(super) fn skip(&mut self, length: u64, what: &'static str) -> Result<(), Error> {
        let mut left = self.claim(length, what)?;
        while left > 0 {
            let step = self.reader.fill_buf().map_err(|error| reading(&error))?.len().min(left);
            if step == 0 {
                return Err(reading(&std::io::ErrorKind::UnexpectedEof.into()));
            }
            self.reader.consume(step);
            left -= step;
        }
        Ok(())
    }

    /// Reads the bytes before a line feed, and the line feed itself; at most [`LONGEST_LINE`].
    pub(super) fn line(&mut self, what: &'static str) -> Result<Vec<u8>, Error> {
        let mut line = Vec::new();
        loop {
            match self.byte(what)? {
                b'\n' => return Ok(line),
                byte if line.len() < LONGEST_LINE => line.push(byte),
                _ => {
                    let limit = LONGEST_LINE as u64;
                    let what = "bytes of a name in the pickle";
                    return Err(beyond(what, limit + 1, limit));
                }
            }
        }
    }

    /// Subtracts `length` bytes from the remaining ones.
    fn claim(&mut self, length: u64, what: &'static str) -> Result<usize, Error> {
        let (Ok(size), Some(remaining)) =
            (usize::try_from(length), self.remaining.checked_sub(length))
        else {
            let (position, available) = (self.position, self.remaining);
            return Err(truncated(what, position, length, available));
        };
        self.position += length;
        self.remaining = remaining;
        Ok(size)
    }
}

/// Returns the operating system's error of a failed read. The caller adds the path.
pub(super) fn reading(error: &std::io::Error) -> Error {
    Error::File { path: String::new(), reason: error.to_string() }
}
