//! What can be wrong with a table of sheets.

use std::io;

use super::Cell;

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
    /// Cells that are not separated by commas.
    #[error("line {line}: separate the cells by commas, not by semicolons or tabs")]
    Separator {
        /// The header's line.
        line: usize,
    },
    /// A column that the sheet does not have.
    #[error("line {line}, column {number}: there is no column {column:?}; there are {known}")]
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
    #[error("line {line}, column {number} ({column}): {found:?} is not possible; give {expected}")]
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
    /// A sheet that is refused as a whole.
    #[error("line {line}: {source}")]
    Sheet {
        /// The line.
        line: usize,
        /// Why.
        source: ergo_map::Error,
    },
    /// The scores cannot be written.
    #[error("cannot write the scores: {0}")]
    Write(io::Error),
}
