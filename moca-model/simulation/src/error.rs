//! What can be wrong with a simulation.

use std::{io, path::PathBuf};

use moca_replay::recorded::ReplayError;
use percept_recording::RecordingError;

/// Why something cannot be simulated: what was wrong, where, and what would be right.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
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
    /// A recording that lacks what it is played for.
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
    /// A simulated person who moves faster than the robot assumes, with whom a judgement means nothing.
    #[error("part {part} of a simulated person moves at {speed} m/s, above {limit} m/s")]
    TooFast {
        /// The part's index.
        part: usize,
        /// How fast it is \[m/s\].
        speed: f64,
        /// How fast it may be \[m/s\].
        limit: f64,
    },
    /// The person's map cannot be fitted.
    #[error("fitting the person's ergonomics")]
    Fit(#[source] ergo_map::Error),
    /// A figure cannot be drawn.
    #[error("cannot draw the figure: {0}")]
    Figure(String),
    /// The system gives no threads.
    #[error("cannot start the threads that play the cases")]
    Threads(#[source] rayon::ThreadPoolBuildError),
    /// The controller or the robot's model refuses something.
    #[error(transparent)]
    Controller(#[from] moca_model::Error),
    /// The shared workspace refuses something.
    #[error(transparent)]
    Workspace(#[from] hrsw::Error),
    /// The person's ergonomics refuse something.
    #[error(transparent)]
    Ergonomics(#[from] ergo_map::Error),
    /// Camera or tracker refuse something.
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
