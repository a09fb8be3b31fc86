//! Errors of recordings.

use std::{io, path::PathBuf};

/// Reason why a recording cannot be read or written: the place, what was found, and what would be right.
/// Lines count from 1, including the header.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// The file cannot be opened.
    #[error("cannot open the recording {path}: {source}", path = path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// The system cannot continue to read or write.
    #[error("line {line}: cannot read or write on: {source}")]
    Io {
        /// The line that failed.
        line: usize,
        /// The system's error.
        source: io::Error,
    },
    /// There is no camera frame.
    #[error(
        "the recording is empty: it has {lines} line(s) and no camera frame; the first line is the \
         header, every further line a frame (the `record` command makes a recording)"
    )]
    Empty {
        /// Number of lines.
        lines: usize,
    },
    /// A line is too long for a frame.
    #[error(
        "line {line} is longer than {limit} bytes: a frame takes about 1000; write one JSON object \
         a line"
    )]
    LineTooLong {
        /// The line.
        line: usize,
        /// Largest length that is read (bytes).
        limit: usize,
    },
    /// The first line is not a header.
    #[error(
        "line {line}: {problem}; the first line of a recording is its header, such as \
         {{\"format\":\"moca-recording\",\"version\":2,\"frame\":\"world\",\"rate\":20.0,\
         \"stature\":1.75}}"
    )]
    Header {
        /// The line.
        line: usize,
        /// The problem.
        problem: String,
    },
    /// The input ends before the closing line.
    #[error(
        "line {line}: the recording is cut off here, after {frames} whole camera frame(s): a whole \
         one ends with a closing line such as {{\"end\":{{\"frames\":{frames},\"complete\":true}}}}"
    )]
    Cut {
        /// The last line, or the missing one.
        line: usize,
        /// Number of complete frames.
        frames: u64,
    },
    /// The closing line says that the recording was interrupted.
    #[error(
        "line {line}: the recording is partial: it was interrupted after {frames} camera frame(s)"
    )]
    Interrupted {
        /// The closing line.
        line: usize,
        /// Number of frames.
        frames: u64,
    },
    /// A closing line is invalid, counts other frames than there are, or is not the last line.
    #[error(
        "line {line}: {problem}; the closing line of a recording of version 2 is such as \
         {{\"end\":{{\"frames\":1119,\"complete\":true}}}}"
    )]
    End {
        /// The line.
        line: usize,
        /// The problem.
        problem: String,
    },
    /// A line is not the JSON of a frame.
    #[error(
        "line {line}, column {column}: {problem}; a frame is one JSON object with the fields time, \
         keypoints, action and surface, and null stands for what was not seen (JSON has no NaN)"
    )]
    Json {
        /// The line.
        line: usize,
        /// The column, in bytes from 1.
        column: usize,
        /// The problem.
        problem: String,
    },
    /// A frame has an impossible value.
    #[error("line {line}: {what} is {got}: give {wanted}")]
    Value {
        /// The line.
        line: usize,
        /// Name of the value.
        what: String,
        /// The value that was found.
        got: String,
        /// The right values.
        wanted: String,
    },
    /// An action or a surface has an unknown name.
    #[error("line {line}: {source}")]
    Name {
        /// The line.
        line: usize,
        /// The error of the name.
        source: Box<vision_models::Error>,
    },
}

impl RecordingError {
    /// Returns true if the recording is valid so far, but ends early: it is truncated, or its
    /// writer was interrupted.
    pub fn is_early_end(&self) -> bool {
        matches!(self, Self::Cut { .. } | Self::Interrupted { .. })
    }
}
