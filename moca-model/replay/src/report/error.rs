//! What can go wrong with a report.

/// Why a report cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// The table cannot be written on.
    #[error(transparent)]
    Table(#[from] csv::Error),
    /// A row of other joints than the table has.
    #[error("a row has {got} joints: give the {wanted} of the table")]
    Joints {
        /// How many the row has.
        got: usize,
        /// How many the table has.
        wanted: usize,
    },
    /// A figure cannot be drawn.
    #[error("cannot draw the figure: {0}")]
    Figure(String),
    /// There is nothing to draw.
    #[error("nothing to draw: give at least one run, each with at least one tick")]
    Nothing,
}
