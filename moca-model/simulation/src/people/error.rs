//! What can be wrong with the settings of a walk.

use std::{io, path::PathBuf};

/// Why there is no walk: what was wrong and what would be right.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WalkerError {
    /// A setting outside its range.
    #[error("{name} = {value}: give {expected}")]
    Setting {
        /// The setting.
        name: &'static str,
        /// The value that was given.
        value: f64,
        /// The values that are right.
        expected: &'static str,
    },
    /// A path that is neither a name nor a list of points.
    #[error(
        "path \"{text}\": give stations, straight, square, circle, figure-eight or random, a list \
         of points on the floor in metres such as \"1.4,0 2.4,0 2.4,-1\", or a file with one point a \
         line"
    )]
    Path {
        /// What was given, or its beginning.
        text: String,
    },
    /// A line of a path's file that is no point.
    #[error(
        "{path}, line {line}: \"{text}\" is no point: give two numbers in metres, such as 1.4,0",
        path = path.display()
    )]
    PathLine {
        /// The file.
        path: PathBuf,
        /// The line.
        line: usize,
        /// What stands there, or its beginning.
        text: String,
    },
    /// A path's file that cannot be read.
    #[error("cannot read the path from {path}: {source}", path = path.display())]
    PathFile {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
}
