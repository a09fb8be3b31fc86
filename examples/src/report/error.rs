//! What can go wrong with a report.

use std::{io, path::PathBuf};

/// Why a report cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// The table's file cannot be created.
    #[error("cannot create {path}: {source}", path = path.display())]
    Create {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The table cannot be written on.
    #[error("cannot write the table of ticks: {0}")]
    Table(#[from] csv::Error),
    /// A figure cannot be drawn.
    #[error("cannot draw the figure: {0}")]
    Figure(String),
    /// There is nothing to draw.
    #[error("nothing to draw: give at least one run, each with at least one tick")]
    Nothing,
}
