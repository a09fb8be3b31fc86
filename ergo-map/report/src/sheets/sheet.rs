//! Interface of sheets.

use super::column::Column;

/// A sheet that assessors complete: its input columns and its scores.
pub trait Sheet: Default + 'static {
    /// Reason for which a whole sheet is refused.
    type Error: std::error::Error + Send + Sync + 'static;

    /// Columns that the table may have.
    const COLUMNS: &'static [Column<Self>];
    /// Columns of other sheets, whose names this sheet does not have.
    const ELSEWHERE: &'static [Elsewhere] = &[];
    /// Names of the scores, in the order of [`Sheet::scores`].
    const SCORES: &'static [&'static str];

    /// Returns the scores as text.
    ///
    /// # Errors
    /// The reason for which the sheet is refused.
    fn scores(&self) -> Result<Vec<String>, Self::Error>;
}

/// A column of another sheet. If it were passed through, it would silently not be scored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Elsewhere {
    /// Name of the column.
    pub name: &'static str,
    /// Name of the other sheet.
    pub sheet: &'static str,
    /// Name of the equivalent column on this sheet, if there is one.
    pub here: Option<&'static str>,
}
