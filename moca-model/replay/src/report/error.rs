//! Errors of a report.

/// Reason why a report cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// The table cannot be written.
    #[error(transparent)]
    Table(#[from] csv::Error),
    /// A row has another number of joints than the table.
    #[error("{what} has {got} joints: give the {wanted} of the table")]
    Size {
        /// The list of the row.
        what: &'static str,
        /// Number of joints of the row.
        got: usize,
        /// Number of joints of the table.
        wanted: usize,
    },
    /// A figure cannot be drawn.
    #[error("cannot draw the figure: {0}")]
    Figure(String),
    /// There is nothing to draw.
    #[error("nothing to draw: give at least one run, each with at least one tick")]
    Nothing,
}
