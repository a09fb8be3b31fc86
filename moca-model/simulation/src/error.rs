//! Errors of simulations.

use std::{io, path::PathBuf};

use moca_replay::recorded::ReplayError;
use percept_recording::RecordingError;

/// Why something cannot be simulated: what is wrong, where, and what would be right.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A setting is outside its range.
    #[error("{name} = {value}: give {expected}")]
    Setting {
        /// The setting.
        name: &'static str,
        /// The value that was given.
        value: f64,
        /// The accepted values.
        expected: &'static str,
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
    /// A path's file cannot be read.
    #[error("cannot read the path from {path}: {source}", path = path.display())]
    PathFile {
        /// The file.
        path: PathBuf,
        /// What the operating system reports.
        source: io::Error,
    },
    /// A recording lacks what is needed.
    #[error("{found}; {wanted}")]
    Unfit {
        /// What is wrong with it.
        found: String,
        /// What would be right.
        wanted: &'static str,
    },
    /// Something is wrong with a file.
    #[error("{path}", path = path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: Box<Error>,
    },
    /// A simulated person moves faster than the robot assumes, so that a judgement has no meaning.
    #[error("part {part} of a simulated person moves at {speed} m/s, above {limit} m/s")]
    TooFast {
        /// The index of the body part.
        part: usize,
        /// Its speed \[m/s\].
        speed: f64,
        /// The largest allowed speed \[m/s\].
        limit: f64,
    },
    /// The person's map cannot be fitted.
    #[error("fitting the person's ergonomics")]
    Fit(#[source] ergo_map::Error),
    /// A figure cannot be drawn.
    #[error("cannot draw the figure: {0}")]
    Figure(String),
    /// The operating system provides no threads.
    #[error("cannot start the threads that play the cases")]
    Threads(#[source] rayon::ThreadPoolBuildError),
    /// The controller or the robot's model reported an error.
    #[error(transparent)]
    Controller(#[from] moca_model::Error),
    /// The shared workspace reported an error.
    #[error(transparent)]
    Workspace(#[from] hrsw::Error),
    /// The person's ergonomics reported an error.
    #[error(transparent)]
    Ergonomics(#[from] ergo_map::Error),
    /// Camera or tracker reported an error.
    #[error(transparent)]
    Vision(#[from] vision_models::Error),
    /// A recording cannot be read.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// The person cannot be perceived.
    #[error(transparent)]
    Perception(Box<human_perception::Error>),
    /// A run cannot be recorded or shown.
    #[error(transparent)]
    Replay(Box<ReplayError>),
}

impl From<whole_body::Error> for Error {
    fn from(error: whole_body::Error) -> Self {
        Self::Controller(error.into())
    }
}

impl From<human_perception::Error> for Error {
    fn from(error: human_perception::Error) -> Self {
        Self::Perception(Box::new(error))
    }
}

impl From<ReplayError> for Error {
    fn from(error: ReplayError) -> Self {
        Self::Replay(Box::new(error))
    }
}
