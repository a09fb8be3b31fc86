//! What makes a sheet.

use super::column::Column;

/// A sheet that assessors fill in: the columns it is read from and the scores it gives.
pub trait Sheet: Default + 'static {
    /// What a sheet as a whole may be refused for.
    type Error: std::error::Error + Send + Sync + 'static;

    /// What the table may hold.
    const COLUMNS: &'static [Column<Self>];
    /// Columns of other sheets, which this one does not have under these names.
    const ELSEWHERE: &'static [Elsewhere] = &[];
    /// The names of the scores, in the order in which [`Sheet::scores`] gives them.
    const SCORES: &'static [&'static str];

    /// The scores as they are written.
    ///
    /// # Errors
    /// What the sheet itself refuses.
    fn scores(&self) -> Result<Vec<String>, Self::Error>;
}

/// A column of another sheet: passed through, it would silently not be scored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Elsewhere {
    /// Its name there.
    pub name: &'static str,
    /// Which sheet has it.
    pub sheet: &'static str,
    /// What the same is called on this sheet, if it is asked for.
    pub here: Option<&'static str>,
}
