//! Filled-in sheets as a table, one a row: read, scored and written with the scores behind.

mod column;
mod error;
mod header;
mod lines;

use std::io::{BufRead, Write};

pub use column::{Cell, Column};
pub use error::TableError;
use header::Matched;
pub use header::Unknown;
use lines::{LONGEST_ROW, Lines};

use crate::program::{WithoutMark, without_byte_order_mark};

/// A sheet that assessors fill in: the columns it is read from and the scores it gives.
pub trait Sheet: Default + 'static {
    /// What a sheet as a whole may be refused for.
    type Error: std::error::Error + Send + Sync + 'static;

    /// What the table may hold.
    const COLUMNS: &'static [Column<Self>];
    /// The names of the scores, in the order in which [`Sheet::scores`] gives them.
    const SCORES: &'static [&'static str];

    /// The scores as they are written.
    ///
    /// # Errors
    /// What the sheet itself refuses.
    fn scores(&self) -> Result<Vec<String>, Self::Error>;
}

/// How much of a table has been scored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// All rows.
    Whole,
    /// Those up to where it was ended.
    Begun,
}

/// A comma-separated table of sheets, whose header has been read.
///
/// The first line names the columns of [`Sheet::COLUMNS`], in any order; other columns are passed
/// through, unless that is not wanted. The scored table has the columns of [`Sheet::SCORES`] behind
/// them.
///
/// ```
/// use ergo_map::Worksheet;
/// use examples::sheets::{Extent, SheetTable, Unknown};
///
/// let table = "id,trunk_flex_deg,neck_flex_deg,knee_flex_deg,upper_arm_flex_deg,\
///              lower_arm_flex_deg,wrist_flex_deg\nlift,70,10,0,30,80,0\n";
/// let mut table = SheetTable::<Worksheet, _>::new(table.as_bytes(), Unknown::PassThrough)?;
/// assert_eq!(table.unknown().collect::<Vec<_>>(), ["id"]);
/// let mut scored = Vec::new();
/// assert_eq!(table.score(&mut scored, |_| true)?, Extent::Whole);
/// let scored = String::from_utf8(scored)?;
/// assert!(scored.ends_with("\nlift,70,10,0,30,80,0,1,4,1,2,1,1,3,3,1,1,2,2,1,2,0.8279687499999999\n"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct SheetTable<S: 'static, R: BufRead> {
    rows: csv::Reader<Lines<WithoutMark<R>>>,
    names: Vec<String>,
    columns: Matched<S>,
}

impl<S: Sheet, R: BufRead> SheetTable<S, R> {
    /// Reads the header.
    ///
    /// # Errors
    /// [`TableError`] with line and column for the first fault.
    pub fn new(table: R, unknown: Unknown) -> Result<Self, TableError> {
        let text = without_byte_order_mark(table)
            .map_err(|source| TableError::Read { line: 1, source })?;
        let mut builder = csv::ReaderBuilder::new();
        let mut rows = builder.has_headers(false).flexible(true).from_reader(Lines::new(text));
        let mut row = csv::StringRecord::new();
        if !read(&mut rows, &mut row)? {
            return Err(TableError::Empty);
        }
        let names: Vec<String> = row.iter().map(str::to_owned).collect();
        let columns = header::matched::<S>(rows.get_ref().line(), &names, unknown)?;
        Ok(Self { rows, names, columns })
    }

    /// The names of the columns that are passed through.
    pub fn unknown(&self) -> impl Iterator<Item = &str> {
        let pairs = self.names.iter().zip(&self.columns);
        pairs.filter(|(_, column)| column.is_none()).map(|(name, _)| name.trim())
    }

    /// Writes the same table with the scores of each row behind it, row by row, as long as
    /// `go_on`, which is given each sheet that has been scored, says so. Rows before a fault have
    /// been written when the error is returned.
    ///
    /// # Errors
    /// [`TableError`] with line and column for the first fault.
    pub fn score(
        &mut self,
        output: impl Write,
        go_on: impl FnMut(&S) -> bool,
    ) -> Result<Extent, TableError> {
        let mut scored = csv::Writer::from_writer(output);
        let outcome = self.append_scores(&mut scored, go_on);
        // What was right before a fault is worth having.
        scored.flush().map_err(TableError::Write)?;
        outcome
    }

    fn append_scores(
        &mut self,
        scored: &mut csv::Writer<impl Write>,
        mut go_on: impl FnMut(&S) -> bool,
    ) -> Result<Extent, TableError> {
        let scores = S::SCORES.iter().copied();
        write(scored, self.names.iter().map(String::as_str).chain(scores))?;
        let mut row = csv::StringRecord::new();
        while read(&mut self.rows, &mut row)? {
            let line = self.rows.get_ref().line();
            let sheet = self.sheet(line, &row)?;
            let scores = sheet.scores();
            let scores =
                scores.map_err(|source| TableError::Sheet { line, source: Box::new(source) })?;
            write(scored, row.iter().chain(scores.iter().map(String::as_str)))?;
            if !go_on(&sheet) {
                return Ok(Extent::Begun);
            }
        }
        Ok(Extent::Whole)
    }

    /// The sheet of a row.
    fn sheet(&self, line: usize, row: &csv::StringRecord) -> Result<S, TableError> {
        let expected = self.columns.len();
        if row.len() != expected {
            return Err(TableError::Cells { line, found: row.len(), expected });
        }
        let mut sheet = S::default();
        for (index, (column, cell)) in self.columns.iter().zip(row).enumerate() {
            let Some(column) = column else { continue };
            column.fill(&mut sheet, cell.trim()).map_err(|expected| TableError::Cell {
                line,
                number: index + 1,
                column: column.name,
                found: cell.into(),
                expected,
            })?;
        }
        Ok(sheet)
    }
}

/// The next row that is not blank.
fn read(
    rows: &mut csv::Reader<Lines<impl BufRead>>,
    row: &mut csv::StringRecord,
) -> Result<bool, TableError> {
    rows.get_mut().begin_row();
    rows.read_record(row).map_err(|error| {
        let lines = rows.get_ref();
        let line = lines.line();
        match error.into_kind() {
            csv::ErrorKind::Io(_) if lines.too_long() => {
                TableError::RowTooLong { line, limit: LONGEST_ROW }
            }
            csv::ErrorKind::Io(source) => TableError::Read { line: line + 1, source },
            _ => TableError::NotText { line },
        }
    })
}

fn write<'a>(
    scored: &mut csv::Writer<impl Write>,
    cells: impl Iterator<Item = &'a str>,
) -> Result<(), TableError> {
    scored.write_record(cells).map_err(|error| TableError::Write(error.into()))
}
