//! Filled-in sheets as a table, one a row: read, scored and written with the scores behind.

mod column;
mod error;
mod lines;
mod reba;
mod rula;

use std::io::{BufRead, Write};

pub use column::{Cell, Column};
pub use error::TableError;
use lines::Lines;

/// A sheet that assessors fill in: the columns it is read from and the scores it gives.
pub trait Sheet: Default + 'static {
    /// What the table may hold.
    const COLUMNS: &'static [Column<Self>];
    /// The names of the scores, in the order in which [`Sheet::scores`] gives them.
    const SCORES: &'static [&'static str];

    /// The scores as they are written.
    ///
    /// # Errors
    /// What the sheet itself refuses.
    fn scores(&self) -> Result<Vec<String>, ergo_map::Error>;
}

/// Reads a comma-separated table of sheets, and writes the same table with the scores of each row
/// behind it, row by row; gives the number of rows. Rows before a fault have been written when the
/// error is returned.
///
/// The first line names the columns of [`Sheet::COLUMNS`], in any order; the output's columns are
/// [`Sheet::SCORES`].
///
/// ```
/// use ergo_map::Worksheet;
/// use examples::ergonomics::score_table;
///
/// let table = "trunk_flex_deg,neck_flex_deg,knee_flex_deg,upper_arm_flex_deg,\
///              lower_arm_flex_deg,wrist_flex_deg\n70,10,0,30,80,0\n";
/// let mut scored = Vec::new();
/// assert_eq!(score_table::<Worksheet>(table.as_bytes(), &mut scored)?, 1);
/// let scored = String::from_utf8(scored)?;
/// assert!(scored.ends_with("\n70,10,0,30,80,0,1,4,1,2,1,1,3,3,1,1,2,2,1,2,0.8279687499999999\n"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`TableError`] with line and column for the first fault.
pub fn score_table<S: Sheet>(table: impl BufRead, output: impl Write) -> Result<usize, TableError> {
    let mut rows =
        csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(Lines::new(table));
    let mut scored = csv::Writer::from_writer(output);
    let outcome = score_rows::<S>(&mut rows, &mut scored);
    // What was right before a fault is worth having.
    scored.flush().map_err(TableError::Write)?;
    outcome
}

fn score_rows<S: Sheet>(
    rows: &mut csv::Reader<Lines<impl BufRead>>,
    scored: &mut csv::Writer<impl Write>,
) -> Result<usize, TableError> {
    let mut row = csv::StringRecord::new();
    if !read(rows, &mut row)? {
        return Err(TableError::Empty);
    }
    let line = rows.get_ref().line();
    // A spreadsheet may have put its mark before the first name.
    let names: Vec<String> = row.iter().map(|n| n.trim_start_matches('\u{feff}').into()).collect();
    let columns = column::matched::<S>(line, &names)?;
    let scores = S::SCORES.iter().copied();
    write(scored, names.iter().map(String::as_str).chain(scores))?;

    let mut count = 0;
    while read(rows, &mut row)? {
        let line = rows.get_ref().line();
        if row.len() != columns.len() {
            return Err(TableError::Cells { line, found: row.len(), expected: columns.len() });
        }
        let mut sheet = S::default();
        for (index, (column, cell)) in columns.iter().zip(&row).enumerate() {
            column.fill(&mut sheet, cell.trim()).map_err(|expected| TableError::Cell {
                line,
                number: index + 1,
                column: column.name,
                found: cell.into(),
                expected,
            })?;
        }
        let scores = sheet.scores().map_err(|source| TableError::Sheet { line, source })?;
        write(scored, row.iter().chain(scores.iter().map(String::as_str)))?;
        count += 1;
    }
    Ok(count)
}

/// The next row that is not blank.
fn read(
    rows: &mut csv::Reader<Lines<impl BufRead>>,
    row: &mut csv::StringRecord,
) -> Result<bool, TableError> {
    rows.read_record(row).map_err(|error| {
        let line = rows.get_ref().line();
        match error.into_kind() {
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
