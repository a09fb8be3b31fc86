//! Errors of tables, maps, questionnaires and their pictures.

use std::{fmt, io};

/// The fault, its place, and what would be valid. Lines and columns count from 1, and the header is
/// a line too.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Reading failed.
    #[error("line {line}: cannot read on: {source}")]
    Read {
        /// Line at which reading failed.
        line: usize,
        /// Error of the operating system.
        source: io::Error,
    },
    /// A table that cannot be read as sheets.
    #[error("{}{problem}", Place(*line, *column))]
    Table {
        /// The line. None for an empty table.
        line: Option<usize>,
        /// Number of the column, if the fault is in one.
        column: Option<usize>,
        /// The content that was found, and what would be valid.
        problem: String,
    },
    /// A sheet that is refused as a whole.
    #[error("line {line}: {source}")]
    Sheet {
        /// The line.
        line: usize,
        /// Reason of the refusal.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// A questionnaire that has no score.
    #[error("{0}")]
    Questionnaire(String),
    /// Questionnaires that cannot be compared.
    #[error("{0}")]
    Study(String),
    /// A hand position outside the map.
    #[error(
        "the hand at ({x:.3}, {y:.3}, {z:.3}) m is outside the map: give a place that the person \
         reaches, x forward, y left, z up from the floor below the pelvis"
    )]
    OutsideMap {
        /// Forward \[m\].
        x: f64,
        /// Left \[m\].
        y: f64,
        /// Up \[m\].
        z: f64,
    },
    /// A map or a table that contains too little.
    #[error(
        "{what} needs at least {wanted} postures and has {got}: give a smaller spacing, or more \
         recorded postures there"
    )]
    TooFewSamples {
        /// The quantity that was to be computed.
        what: &'static str,
        /// Number of postures that there are.
        got: usize,
        /// Smallest sufficient number.
        wanted: usize,
    },
    /// The map has no result, or the measures of the person are invalid.
    #[error(transparent)]
    Map(ergo_map::Error),
    /// A setting is outside its range.
    #[error("{what} = {got}: give {wanted}")]
    Value {
        /// The setting.
        what: &'static str,
        /// The value that was given.
        got: f64,
        /// The allowed range.
        wanted: &'static str,
    },
    /// A picture cannot be drawn.
    #[error("cannot draw the {what}: {reason}")]
    Drawing {
        /// `picture` or `figure`.
        what: &'static str,
        /// Reason of the failure.
        reason: String,
    },
    /// Scores or a report cannot be written.
    #[error("cannot write the {what}: {source}")]
    Write {
        /// `scores` or `report`.
        what: &'static str,
        /// Error of the operating system.
        source: io::Error,
    },
}

impl Error {
    /// Creates the error for a fault in a line of a table.
    pub(crate) fn in_line(line: usize, problem: impl Into<String>) -> Self {
        Self::Table { line: Some(line), column: None, problem: problem.into() }
    }

    /// Creates the error for a fault in a column of a table.
    pub(crate) fn in_column(line: usize, column: usize, problem: impl Into<String>) -> Self {
        Self::Table { line: Some(line), column: Some(column), problem: problem.into() }
    }
}

impl From<ergo_map::Error> for Error {
    fn from(error: ergo_map::Error) -> Self {
        match error {
            ergo_map::Error::OutOfDomain { x, y, z } => Self::OutsideMap { x, y, z },
            ergo_map::Error::TooFewSamples { what, got, wanted } => {
                Self::TooFewSamples { what, got, wanted }
            }
            other => Self::Map(other),
        }
    }
}

/// Place in a table.
struct Place(Option<usize>, Option<usize>);

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.0, self.1) {
            // The message that follows starts with the name of the column.
            (Some(line), Some(column)) => write!(f, "line {line}, column {column}"),
            (Some(line), None) => write!(f, "line {line}: "),
            _ => Ok(()),
        }
    }
}
