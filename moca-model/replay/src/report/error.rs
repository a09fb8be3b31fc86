//! What can go wrong with a report.

/// Why a report cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// The table cannot be written on.
    #[error(transparent)]
    Table(#[from] csv::Error),
    /// A figure cannot be drawn.
    #[error("cannot draw the figure: {0}")]
    Figure(String),
    /// There is nothing to draw.
    #[error("nothing to draw: give at least one run, each with at least one tick")]
    Nothing,
}
