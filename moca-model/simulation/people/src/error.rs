//! Errors of simulated people.

use std::{io, ops::RangeInclusive, path::PathBuf};

use super::built_in::NAMES;

/// Reason why a person cannot be simulated: the fault, its place, and what would be right.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A setting is outside its range.
    #[error("{what} = {got}: give {wanted}")]
    Value {
        /// The setting.
        what: &'static str,
        /// The value that was given.
        got: f64,
        /// The accepted values.
        wanted: &'static str,
    },
    /// A path is neither a name nor a list of points.
    #[error(
        "path \"{text}\": give stations, straight, square, circle, figure-eight or random, a list \
         of points on the floor in metres such as \"1.4,0 2.4,0 2.4,-1\", or a file with one point a \
         line"
    )]
    Path {
        /// The text, or its beginning.
        text: String,
    },
    /// A line of a path's file is not a point.
    #[error(
        "{path}, line {line}: \"{text}\" is no point: give two numbers in metres, such as 1.4,0",
        path = path.display()
    )]
    PathLine {
        /// The file.
        path: PathBuf,
        /// The line.
        line: usize,
        /// The text, or its beginning.
        text: String,
    },
    /// A motion has no such name.
    #[error("motion \"{name}\": give {}, or a recording of a person", NAMES.join(", "))]
    MotionName {
        /// The name.
        name: String,
    },
    /// A recording cannot be played as a motion.
    #[error("this recording is no motion to repeat: {found}; {wanted}")]
    Motion {
        /// The fault.
        found: String,
        /// What would be right.
        wanted: &'static str,
    },
    /// The recording of a motion cannot be opened.
    #[error(transparent)]
    Open(percept_recording::RecordingError),
    /// The recording of a motion cannot be read.
    #[error("{path}: {source}", path = path.display())]
    MotionFile {
        /// The file.
        path: PathBuf,
        /// The fault.
        source: percept_recording::RecordingError,
    },
    /// A path's file cannot be read.
    #[error("cannot read the path from {path}: {source}", path = path.display())]
    PathFile {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
}

/// Checks a setting.
///
/// # Errors
/// [`Error::Value`] outside the range, and for NaN.
pub fn in_range(
    what: &'static str,
    got: f64,
    range: RangeInclusive<f64>,
    wanted: &'static str,
) -> Result<(), Error> {
    if range.contains(&got) { Ok(()) } else { Err(Error::Value { what, got, wanted }) }
}
