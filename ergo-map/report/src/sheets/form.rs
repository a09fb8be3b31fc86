//! Format in which a spreadsheet has written a table.

use std::io::{BufRead, Read, Result};

use super::lines::LONGEST_ROW;

/// The cell separator, and whether the file declares it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Form {
    pub(super) delimiter: u8,
    /// True if the first line declares the separator, such as `sep=;`.
    pub(super) declared: bool,
}

/// Optional beginning of UTF-8 texts.
const BYTE_ORDER_MARK: [u8; 3] = [0xef, 0xbb, 0xbf];
/// Possible cell separators. The first one is the default.
const DELIMITERS: [u8; 3] = *b",;\t";

impl Form {
    /// Excel separates cells by semicolons if commas precede decimals.
    pub(super) fn has_decimal_comma(self) -> bool {
        self.delimiter == b';'
    }

    /// Reads up to the first line that is not blank. Returns the part of the table that has been
    /// read.
    pub(super) fn read(text: &mut impl BufRead) -> Result<(Self, Vec<u8>)> {
        let mut begun = Vec::new();
        loop {
            let start = begun.len();
            let limit = LONGEST_ROW.saturating_sub(start) as u64;
            let read = text.by_ref().take(limit).read_until(b'\n', &mut begun)?;
            if start == 0 && begun.starts_with(&BYTE_ORDER_MARK) {
                begun.drain(..BYTE_ORDER_MARK.len());
            }
            let line = begun.get(start..).unwrap_or_default().trim_ascii();
            if let (true, Some(delimiter)) = (start == 0, declared(line)) {
                return Ok((Self { delimiter, declared: true }, Vec::new()));
            }
            if read == 0 || !line.is_empty() {
                let form = Self { delimiter: separating(line), declared: false };
                return Ok((form, begun));
            }
        }
    }
}

/// Returns the separator that a line such as `sep=;` declares.
fn declared(line: &[u8]) -> Option<u8> {
    let line = line.strip_prefix(b"\"").and_then(|line| line.strip_suffix(b"\"")).unwrap_or(line);
    let (name, mark) = line.split_at_checked(4)?;
    // Only a tab is trimmed off the end of a line.
    let mark = if mark.is_empty() { b"\t" } else { mark };
    let known = DELIMITERS.into_iter().find(|delimiter| mark == [*delimiter])?;
    name.eq_ignore_ascii_case(b"sep=").then_some(known)
}

/// Returns the separator that occurs most often in a line outside quotation marks.
fn separating(line: &[u8]) -> u8 {
    let mut counts = [0_usize; DELIMITERS.len()];
    let mut quoted = false;
    for byte in line {
        quoted ^= *byte == b'"';
        for (count, delimiter) in counts.iter_mut().zip(DELIMITERS) {
            *count += usize::from(!quoted && *byte == delimiter);
        }
    }
    let marks = DELIMITERS.into_iter().zip(counts);
    // The first one wins if several occur equally often.
    marks.rev().max_by_key(|(_, count)| *count).map_or(b',', |(mark, _)| mark)
}
