//! Tables of sheets: read row by row, scored and written.

use std::io::{self, BufRead, Chain, Cursor, Read, Write};
use std::ops::ControlFlow;

use super::column::{Cell, Numbers, RATINGS_END};
use super::form::Form;
use super::header::{self, Matched, Shown, Unknown};
use super::lines::{LONGEST_ROW, Lines};
use super::sheet::Sheet;
use crate::error::Error;

/// A table of sheets as spreadsheets write it, whose header has been read.
///
/// Cells are separated by commas, semicolons or tabs. The header determines the separator, or a
/// line `sep=;` before it. If it is a semicolon, a comma may precede decimals, and does so in the
/// scores. Empty rows are skipped.
///
/// The first line names the columns of [`Sheet::COLUMNS`], in any order. Other columns are passed
/// through, unless that is refused. The scored table has the columns of [`Sheet::SCORES`] after
/// them.
///
/// ```
/// use std::ops::ControlFlow;
///
/// use ergo_map::Worksheet;
/// use ergo_report::sheets::{SheetTable, Unknown};
///
/// let table = "id,trunk_flex_deg,neck_flex_deg,knee_flex_deg,upper_arm_flex_deg,\
///              lower_arm_flex_deg,wrist_flex_deg\nlift,70,10,0,30,80,0\n";
/// let mut table = SheetTable::<Worksheet, _>::new(table.as_bytes(), Unknown::PassThrough)?;
/// assert_eq!(table.unknown().collect::<Vec<_>>(), ["id"]);
/// let mut scored = Vec::new();
/// let rows = table.score(&mut scored, |_| ControlFlow::Continue(()))?;
/// assert!(rows.is_continue());
/// let scored = String::from_utf8(scored)?;
/// assert!(scored.ends_with("\nlift,70,10,0,30,80,0,1,4,1,2,1,1,3,3,1,1,2,2,1,2,0.8279687499999999\n"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct SheetTable<S: 'static, R: BufRead> {
    rows: csv::Reader<Lines<Text<R>>>,
    form: Form,
    numbers: Numbers,
    names: Vec<String>,
    columns: Matched<S>,
}

/// The header, which has been read to determine the format, and the rest.
type Text<R> = Chain<Cursor<Vec<u8>>, R>;

impl<S: Sheet, R: BufRead> SheetTable<S, R> {
    /// Reads the header.
    ///
    /// # Errors
    /// [`Error`] with line and column of the first fault.
    pub fn new(mut table: R, unknown: Unknown) -> Result<Self, Error> {
        let unread = |source| Error::Read { line: 1, source };
        let (form, begun) = Form::read(&mut table).map_err(unread)?;
        let text = Cursor::new(begun).chain(table);
        let mut builder = csv::ReaderBuilder::new();
        builder.has_headers(false).flexible(true).delimiter(form.delimiter);
        let mut rows = builder.from_reader(Lines::new(text, usize::from(form.declared)));
        let mut row = csv::StringRecord::new();
        if !read(&mut rows, &mut row)? {
            return Err(Error::Table {
                line: None,
                column: None,
                problem: "the table is empty; its first line must name the columns".into(),
            });
        }
        let names: Vec<String> = row.iter().map(str::to_owned).collect();
        let columns = header::matched::<S>(rows.get_ref().line(), &names, unknown)?;
        let decimal_comma = form.has_decimal_comma();
        let numbers = Numbers { decimal_comma, ratings_end: RATINGS_END };
        Ok(Self { rows, form, numbers, names, columns })
    }

    /// Reads ratings from 0 to 100, which become 0 to 20 on the sheets.
    #[must_use]
    pub fn with_ratings_to_hundred(mut self) -> Self {
        self.numbers.ratings_end = 100.0;
        self
    }

    /// Names of the columns that are passed through.
    pub fn unknown(&self) -> impl Iterator<Item = &str> {
        let pairs = self.names.iter().zip(&self.columns);
        pairs.filter(|(_, column)| column.is_none()).map(|(name, _)| name.trim())
    }

    /// Writes the same table with the scores appended to each row, row by row.
    ///
    /// `each` is called with every scored sheet, and may stop the process. If there is a fault, the
    /// rows before it have been written. Returns whether all rows are scored, or `each` has stopped
    /// it.
    ///
    /// # Errors
    /// [`Error`] with line and column of the first fault.
    pub fn score(
        &mut self,
        mut output: impl Write,
        each: impl FnMut(&S) -> ControlFlow<()>,
    ) -> Result<ControlFlow<()>, Error> {
        if self.form.declared {
            let mark = char::from(self.form.delimiter);
            writeln!(output, "sep={mark}").map_err(unwritten)?;
        }
        let mut builder = csv::WriterBuilder::new();
        let mut scored = builder.delimiter(self.form.delimiter).from_writer(output);
        let outcome = self.append_scores(&mut scored, each);
        // Rows before a fault are valid and are kept.
        scored.flush().map_err(unwritten)?;
        outcome
    }

    fn append_scores(
        &mut self,
        scored: &mut csv::Writer<impl Write>,
        mut each: impl FnMut(&S) -> ControlFlow<()>,
    ) -> Result<ControlFlow<()>, Error> {
        let scores = S::SCORES.iter().copied();
        write(scored, self.names.iter().map(String::as_str).chain(scores))?;
        let mut row = csv::StringRecord::new();
        while read(&mut self.rows, &mut row)? {
            let line = self.rows.get_ref().line();
            let sheet = self.sheet(line, &row)?;
            let scores = sheet.scores();
            let mut scores =
                scores.map_err(|source| Error::Sheet { line, source: Box::new(source) })?;
            if self.numbers.decimal_comma {
                for score in &mut scores {
                    *score = score.replace('.', ",");
                }
            }
            write(scored, row.iter().chain(scores.iter().map(String::as_str)))?;
            if each(&sheet).is_break() {
                return Ok(ControlFlow::Break(()));
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    /// Returns the sheet of a row.
    fn sheet(&self, line: usize, row: &csv::StringRecord) -> Result<S, Error> {
        let expected = self.columns.len();
        if row.len() != expected {
            let problem = format!(
                "{} cells where the header names {expected}; write decimals with a point and give \
                 every column a cell",
                row.len()
            );
            return Err(Error::in_line(line, problem));
        }
        let mut sheet = S::default();
        for (index, (column, cell)) in self.columns.iter().zip(row).enumerate() {
            let Some(column) = column else { continue };
            column.fill(&mut sheet, cell.trim(), self.numbers).map_err(|expected| {
                let (name, found, end) = (column.name, Shown(cell), self.numbers.ratings_end);
                let expected = if expected == Cell::Rating && end != RATINGS_END {
                    format!("a rating from 0 to {end}")
                } else {
                    expected.to_string()
                };
                let problem = format!(" ({name}): {found:?} is not possible; give {expected}");
                Error::in_column(line, index + 1, problem)
            })?;
        }
        Ok(sheet)
    }
}

/// Reads the next row that is not blank, since spreadsheets end tables with rows of empty cells.
fn read(
    rows: &mut csv::Reader<Lines<impl BufRead>>,
    row: &mut csv::StringRecord,
) -> Result<bool, Error> {
    loop {
        rows.get_mut().begin_row();
        let found = rows.read_record(row).map_err(|error| {
            let lines = rows.get_ref();
            let line = lines.line();
            match error.into_kind() {
                csv::ErrorKind::Io(_) if lines.too_long() => {
                    let what = "is a quotation mark open?";
                    Error::in_line(line, format!("a row of more than {LONGEST_ROW} bytes; {what}"))
                }
                csv::ErrorKind::Io(source) => Error::Read { line: line + 1, source },
                _ => Error::in_line(line, "not UTF-8 text; save the table as CSV in UTF-8"),
            }
        })?;
        if !found || row.iter().any(|cell| !cell.trim().is_empty()) {
            return Ok(found);
        }
    }
}

fn write<'a>(
    scored: &mut csv::Writer<impl Write>,
    cells: impl Iterator<Item = &'a str>,
) -> Result<(), Error> {
    scored.write_record(cells).map_err(|error| unwritten(error.into()))
}

fn unwritten(source: io::Error) -> Error {
    Error::Write { what: "scores", source }
}
