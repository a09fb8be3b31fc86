//! The first line of a table, which names the columns.

use std::fmt;

use super::column::Column;
use super::sheet::{Elsewhere, Sheet};
use crate::error::Error;

/// Largest number of columns of a table.
const MOST_COLUMNS: usize = 1000;
/// Names that differ by at most this many letters count as a spelling mistake.
const SLIP: usize = 2;
/// Largest number of characters of a name or a cell in a message.
const LONGEST_SHOWN: usize = 60;
/// The column of each name in the header. None for a column that the sheet does not have.
pub(super) type Matched<S> = Vec<Option<&'static Column<S>>>;

/// Treatment of columns that the sheet does not have.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Unknown {
    /// They are passed through unchanged.
    #[default]
    PassThrough,
    /// The table is refused.
    Refuse,
}

/// Returns the column of each name in the header. None for a column that is passed through.
///
/// A name close to one of the sheet's is always refused, since the scores would silently leave it
/// out.
pub(super) fn matched<S: Sheet>(
    line: usize,
    names: &[String],
    unknown: Unknown,
) -> Result<Matched<S>, Error> {
    if names.len() > MOST_COLUMNS {
        let found = names.len();
        let problem = format!("{found} columns; a table has at most {MOST_COLUMNS}");
        return Err(Error::in_line(line, problem));
    }
    let mut columns: Matched<S> = Vec::new();
    for (index, name) in names.iter().enumerate() {
        let number = index + 1;
        let column = S::COLUMNS.iter().find(|column| column.name == name.trim());
        match column {
            Some(column) if columns.iter().flatten().any(|other| other.name == column.name) => {
                let problem = format!(": {} appears twice; keep one", column.name);
                return Err(Error::in_column(line, number, problem));
            }
            Some(_) => {}
            None => refuse::<S>(line, number, name, unknown)?,
        }
        columns.push(column);
    }
    let present = |column: &&Column<S>| columns.iter().flatten().any(|c| c.name == column.name);
    let missing = S::COLUMNS.iter().filter(|column| column.needed && !present(column));
    let missing: Vec<&str> = missing.map(|column| column.name).collect();
    if missing.is_empty() {
        Ok(columns)
    } else {
        let missing = missing.join(", ");
        Err(Error::in_line(line, format!("missing columns: {missing}; add them")))
    }
}

/// Returns an error for a column that the sheet does not have, if it is not allowed.
fn refuse<S: Sheet>(line: usize, number: usize, name: &str, unknown: Unknown) -> Result<(), Error> {
    if name.contains([';', '\t']) {
        let problem = "separate the cells by commas, by semicolons or by tabs throughout";
        return Err(Error::in_line(line, problem));
    }
    let column = name.trim();
    let refused = |problem: String| Err(Error::in_column(line, number, format!(": {problem}")));
    if S::SCORES.contains(&column) {
        return refused(format!(
            "{column:?} is the name of a score that is added to the table; rename or remove the column"
        ));
    }
    let plain = plain(name);
    if let Some(known) = S::ELSEWHERE.iter().find(|known| known.name == plain) {
        let Elsewhere { name: column, sheet, here } = *known;
        let instead = here.map_or_else(
            || "this sheet does not ask for it: remove the column".to_owned(),
            |name| format!("here it is {name}"),
        );
        return refused(format!("{column} is a column of {sheet}; {instead}"));
    }
    let distance = |known: &str| strsim::osa_distance(&plain, known);
    let nearest = S::COLUMNS
        .iter()
        .map(|column| column.name)
        .filter(|known| known.len().abs_diff(plain.len()) <= SLIP)
        .map(|known| (distance(known), known))
        .min();
    if let Some((distance, known)) = nearest
        && distance <= SLIP
    {
        return refused(format!("there is no column {column:?}; do you mean {known}?"));
    }
    match unknown {
        Unknown::PassThrough => Ok(()),
        Unknown::Refuse => {
            let known = S::COLUMNS.iter().map(|column| column.name);
            let known = known.collect::<Vec<_>>().join(", ");
            refused(format!("there is no column {:?}; there are {known}", Shown(column)))
        }
    }
}

/// Returns a name in the form of the sheet's columns: lower case, with underscores between words.
fn plain(name: &str) -> String {
    name.trim().to_lowercase().replace([' ', '-', '.'], "_")
}

/// A text that is shortened to its beginning in messages.
pub(super) struct Shown<'a>(pub(super) &'a str);

impl fmt::Debug for Shown<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0.char_indices().nth(LONGEST_SHOWN) {
            Some((end, _)) => write!(f, "{:?}… ({} bytes)", &self.0[..end], self.0.len()),
            None => write!(f, "{:?}", self.0),
        }
    }
}
