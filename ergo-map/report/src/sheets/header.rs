//! The first line of a table: which columns there are.

use super::column::Column;
use super::error::{Instead, TableError};
use super::sheet::{Elsewhere, Sheet};

/// No table has more columns.
const MOST_COLUMNS: usize = 1000;
/// Names that differ by so many letters, or fewer, are taken for a slip of the pen.
const SLIP: usize = 2;
/// What columns are called that the table may hold beside the sheets'.
pub(super) type Matched<S> = Vec<Option<&'static Column<S>>>;

/// What becomes of columns that the sheet does not have.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Unknown {
    /// They are passed through unchanged.
    #[default]
    PassThrough,
    /// The table is refused.
    Refuse,
}

/// The column of each name in the header; none for a column that is passed through.
///
/// A name that is nearly one of the sheet's is refused whatever is wanted of unknown ones: the
/// scores would silently leave it out.
pub(super) fn matched<S: Sheet>(
    line: usize,
    names: &[String],
    unknown: Unknown,
) -> Result<Matched<S>, TableError> {
    if names.len() > MOST_COLUMNS {
        return Err(TableError::Columns { line, found: names.len(), most: MOST_COLUMNS });
    }
    let mut columns: Matched<S> = Vec::new();
    for (index, name) in names.iter().enumerate() {
        let number = index + 1;
        let column = S::COLUMNS.iter().find(|column| column.name == name.trim());
        match column {
            Some(column) if columns.iter().flatten().any(|other| other.name == column.name) => {
                return Err(TableError::RepeatedColumn { line, number, column: column.name });
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
        Err(TableError::MissingColumns { line, columns: missing.join(", ") })
    }
}

/// Says what is wrong with a column that the sheet does not have, if anything is.
fn refuse<S: Sheet>(
    line: usize,
    number: usize,
    name: &str,
    unknown: Unknown,
) -> Result<(), TableError> {
    if name.contains([';', '\t']) {
        return Err(TableError::Separator { line });
    }
    let column = name.trim().to_owned();
    if S::SCORES.contains(&name.trim()) {
        return Err(TableError::ScoreColumn { line, number, column });
    }
    let plain = plain(name);
    if let Some(known) = S::ELSEWHERE.iter().find(|known| known.name == plain) {
        let Elsewhere { name: column, sheet, here } = *known;
        let instead = here.map_or(Instead::Remove, Instead::Name);
        return Err(TableError::OtherSheet { line, number, column, sheet, instead });
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
        return Err(TableError::NearlyColumn { line, number, column, known });
    }
    match unknown {
        Unknown::PassThrough => Ok(()),
        Unknown::Refuse => {
            let known = S::COLUMNS.iter().map(|column| column.name);
            let known = known.collect::<Vec<_>>().join(", ");
            Err(TableError::UnknownColumn { line, number, column, known })
        }
    }
}

/// A name as the sheet's columns are written: small letters, with underscores between words.
fn plain(name: &str) -> String {
    name.trim().to_lowercase().replace([' ', '-', '.'], "_")
}
