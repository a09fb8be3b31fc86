//! What can be wrong with a table of sheets.

use std::{fmt, io};

use super::column::Cell;

/// No more characters of a cell are shown in a message.
const LONGEST_SHOWN: usize = 60;

/// Why a table cannot be scored: where, what stands there, and what would be right. Lines and
/// columns count from 1; the header is a line too.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// The system cannot read on.
    #[error("line {line}: cannot read on: {source}")]
    Read {
        /// The line that failed.
        line: usize,
        /// What the system says.
        source: io::Error,
    },
    /// Bytes that are no text.
    #[error("line {line}: not UTF-8 text; save the table as CSV in UTF-8")]
    NotText {
        /// The line.
        line: usize,
    },
    /// Nothing at all.
    #[error("the table is empty; its first line must name the columns")]
    Empty,
    /// Cells that are separated now by one mark and now by another.
    #[error("line {line}: separate the cells by commas, by semicolons or by tabs throughout")]
    Separator {
        /// The header's line.
        line: usize,
    },
    /// More columns than any table of sheets has.
    #[error("line {line}: {found} columns; a table has at most {most}")]
    Columns {
        /// The header's line.
        line: usize,
        /// How many there are.
        found: usize,
        /// The most that is taken.
        most: usize,
    },
    /// A row that is longer than any row of sheets.
    #[error("line {line}: a row of more than {limit} bytes; is a quotation mark open?")]
    RowTooLong {
        /// The line on which the row became too long.
        line: usize,
        /// The most that is read.
        limit: usize,
    },
    /// A column that is called like a score that this table will get.
    #[error(
        "line {line}, column {number}: {column:?} is the name of a score that is added to the \
         table; rename or remove the column"
    )]
    ScoreColumn {
        /// The header's line.
        line: usize,
        /// The column's number.
        number: usize,
        /// Its name.
        column: String,
    },
    /// A column that is nearly one of the sheet's.
    #[error("line {line}, column {number}: there is no column {column:?}; do you mean {known}?")]
    NearlyColumn {
        /// The header's line.
        line: usize,
        /// The column's number.
        number: usize,
        /// Its name.
        column: String,
        /// The name that is so near.
        known: &'static str,
    },
    /// A column that another sheet has, and this one not under this name.
    #[error("line {line}, column {number}: {column} is a column of {sheet}; {instead}")]
    OtherSheet {
        /// The header's line.
        line: usize,
        /// The column's number.
        number: usize,
        /// Its name.
        column: &'static str,
        /// Whose it is.
        sheet: &'static str,
        /// What would be right.
        instead: Instead,
    },
    /// A column that the sheet does not have.
    #[error(
        "line {line}, column {number}: there is no column {column:?}; there are {known}", column = Shown(column)
    )]
    UnknownColumn {
        /// The header's line.
        line: usize,
        /// The column's number.
        number: usize,
        /// Its name.
        column: String,
        /// The names that would be right.
        known: String,
    },
    /// A column that is there twice.
    #[error("line {line}, column {number}: {column} appears twice; keep one")]
    RepeatedColumn {
        /// The header's line.
        line: usize,
        /// The second one's number.
        number: usize,
        /// Its name.
        column: &'static str,
    },
    /// Columns without which there is no score.
    #[error("line {line}: missing columns: {columns}; add them")]
    MissingColumns {
        /// The header's line.
        line: usize,
        /// Their names.
        columns: String,
    },
    /// More or fewer cells than columns.
    #[error(
        "line {line}: {found} cells where the header names {expected}; write decimals with a point \
         and give every column a cell"
    )]
    Cells {
        /// The line.
        line: usize,
        /// Cells there.
        found: usize,
        /// Columns.
        expected: usize,
    },
    /// A cell that makes no sense.
    #[error(
        "line {line}, column {number} ({column}): {found:?} is not possible; give {expected}", found = Shown(found)
    )]
    Cell {
        /// The line.
        line: usize,
        /// The column's number.
        number: usize,
        /// Its name.
        column: &'static str,
        /// What stands there.
        found: String,
        /// What would be right.
        expected: Cell,
    },
    /// A rating beyond the end of its scale, where that is not a sheet's own.
    #[error(
        "line {line}, column {number} ({column}): {found:?} is not possible; give a rating from 0 to {end}", found = Shown(found)
    )]
    Rating {
        /// The line.
        line: usize,
        /// The column's number.
        number: usize,
        /// Its name.
        column: &'static str,
        /// What stands there.
        found: String,
        /// The end of the scale.
        end: f64,
    },
    /// A sheet that is refused as a whole.
    #[error("line {line}: {source}")]
    Sheet {
        /// The line.
        line: usize,
        /// Why.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// The scores cannot be written.
    #[error("cannot write the scores: {0}")]
    Write(io::Error),
}

/// What to do with a column of another sheet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Instead {
    /// This sheet has another name for it.
    Name(&'static str),
    /// This sheet does not ask for it.
    Remove,
}

impl fmt::Display for Instead {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Name(name) => write!(f, "here it is {name}"),
            Self::Remove => write!(f, "this sheet does not ask for it: remove the column"),
        }
    }
}

/// A text that may be long: its beginning is enough in a message.
struct Shown<'a>(&'a str);

impl fmt::Debug for Shown<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0.char_indices().nth(LONGEST_SHOWN) {
            Some((end, _)) => write!(f, "{:?}… ({} bytes)", &self.0[..end], self.0.len()),
            None => write!(f, "{:?}", self.0),
        }
    }
}
