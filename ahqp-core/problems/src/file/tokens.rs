//! Words of a text with their lines.

use std::io::BufRead;

use super::INFINITE;
use crate::file::error::HqpError;

/// Length of the longest number or name (bytes).
const LONGEST_WORD: usize = 256;

/// Numbers that are allowed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Number {
    Finite,
    /// Any number except NaN. From ±1e30 on it is infinite.
    Bound,
}

#[derive(Debug)]
pub(super) struct Tokens<R> {
    input: R,
    line: usize,
    word: Vec<u8>,
}

impl<R> Tokens<R> {
    /// Returns the line that was read last.
    pub(super) fn line(&self) -> usize {
        self.line
    }
}

impl<R: BufRead> Tokens<R> {
    pub(super) fn new(input: R) -> Self {
        Self { input, line: 1, word: Vec::new() }
    }

    /// Reads a word that must equal `keyword`.
    pub(super) fn keyword(&mut self, keyword: &str, begins: &str) -> Result<(), HqpError> {
        // The file may begin with a byte-order mark.
        let is_first = self.line == 1;
        let found = self.next(|| format!("`{keyword}`, with which {begins} begins,"))?;
        if found == keyword || is_first && found.strip_prefix('\u{feff}') == Some(keyword) {
            return Ok(());
        }
        let (expected, found) = (format!("`{keyword}`"), found.to_owned());
        Err(HqpError::Unexpected { line: self.line, got: found, wanted: expected })
    }

    pub(super) fn word(&mut self, what: &'static str) -> Result<String, HqpError> {
        self.next(|| what.to_owned()).map(str::to_owned)
    }

    /// Reads one of two words, and returns its value.
    pub(super) fn choice<T>(
        &mut self,
        what: &'static str,
        [one, other]: [(&'static str, T); 2],
    ) -> Result<T, HqpError> {
        let found = self.next(|| what.to_owned())?;
        if found == one.0 {
            return Ok(one.1);
        }
        if found == other.0 {
            return Ok(other.1);
        }
        let expected = format!("{what}, {} or {},", one.0, other.0);
        let found = found.to_owned();
        Err(HqpError::Unexpected { line: self.line, got: found, wanted: expected })
    }

    pub(super) fn count(&mut self, what: &'static str) -> Result<usize, HqpError> {
        let found = self.next(|| what.to_owned())?;
        found.parse().map_err(|_| found.to_owned()).map_err(|got| HqpError::Value {
            line: self.line,
            what,
            got,
            wanted: "a whole number, not negative".to_owned(),
        })
    }

    pub(super) fn count_up_to(
        &mut self,
        what: &'static str,
        least: usize,
        most: usize,
    ) -> Result<usize, HqpError> {
        let found = self.count(what)?;
        if (least..=most).contains(&found) {
            return Ok(found);
        }
        let (got, wanted) = (found.to_string(), format!("between {least} and {most}"));
        Err(HqpError::Value { line: self.line, what, got, wanted })
    }

    pub(super) fn number(&mut self, what: &'static str, kind: Number) -> Result<f64, HqpError> {
        let found = self.next(|| what.to_owned())?;
        let value: f64 = found.parse().unwrap_or(f64::NAN);
        match kind {
            Number::Bound if value >= INFINITE => Ok(f64::INFINITY),
            Number::Bound if value <= -INFINITE => Ok(f64::NEG_INFINITY),
            _ if value.is_finite() => Ok(value),
            _ => {
                let expected = match kind {
                    Number::Finite => "a finite number",
                    Number::Bound => "a number (±1e30 where there is no bound)",
                };
                let (got, wanted) = (found.to_owned(), expected.to_owned());
                Err(HqpError::Value { line: self.line, what, got, wanted })
            }
        }
    }

    /// Checks that only white space follows.
    pub(super) fn end(&mut self, what: &'static str) -> Result<(), HqpError> {
        if !self.advance()? {
            return Ok(());
        }
        Err(HqpError::Unexpected {
            line: self.line,
            wanted: format!("the end of the file, after {what},"),
            got: String::from_utf8_lossy(&self.word).into_owned(),
        })
    }

    fn next(&mut self, expected: impl FnOnce() -> String) -> Result<&str, HqpError> {
        if !self.advance()? {
            return Err(HqpError::Ended { line: self.line, wanted: expected() });
        }
        let line = self.line;
        str::from_utf8(&self.word).map_err(|_| HqpError::Unexpected {
            line,
            wanted: expected(),
            got: String::from_utf8_lossy(&self.word).into_owned(),
        })
    }

    /// Reads the next word. Returns false at the end of the text.
    fn advance(&mut self) -> Result<bool, HqpError> {
        self.word.clear();
        loop {
            let line = self.line;
            let buffer = match self.input.fill_buf() {
                Ok(buffer) => buffer,
                Err(error) if error.kind() == std::io::ErrorKind::Interrupted => continue,
                Err(source) => return Err(HqpError::Io { line, source }),
            };
            if buffer.is_empty() {
                return Ok(!self.word.is_empty());
            }
            let mut used = 0;
            if self.word.is_empty() {
                used = buffer.iter().take_while(|byte| byte.is_ascii_whitespace()).count();
                self.line += buffer[..used].split(|&byte| byte == b'\n').count() - 1;
            }
            let rest = &buffer[used..];
            let length = rest.iter().take_while(|byte| !byte.is_ascii_whitespace()).count();
            if self.word.len() + length > LONGEST_WORD {
                return Err(HqpError::WordTooLong { line: self.line, limit: LONGEST_WORD });
            }
            self.word.extend_from_slice(&rest[..length]);
            let complete = length < rest.len() && !self.word.is_empty();
            self.input.consume(used + length);
            if complete {
                return Ok(true);
            }
        }
    }
}
