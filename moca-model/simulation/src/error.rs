//! Errors of simulations.

use std::path::PathBuf;

use moca_replay::recorded::ReplayError;
use percept_recording::RecordingError;

/// Reason why something cannot be simulated: the fault, its place, and what would be right.
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
    /// A recording lacks what is needed.
    #[error("{found}; {wanted}")]
    Unfit {
        /// Fault of the recording.
        found: String,
        /// Remedy.
        wanted: &'static str,
    },
    /// Something is wrong with a file.
    #[error("{path}", path = path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Error behind it.
        source: Box<Error>,
    },
    /// A simulated person moves faster than the robot assumes, so that a judgement has no meaning.
    #[error("part {part} of a simulated person moves at {speed:.3} m/s, above {limit} m/s")]
    TooFast {
        /// The index of the body part.
        part: usize,
        /// Speed of the part \[m/s\].
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
    /// A person cannot be simulated.
    #[error(transparent)]
    People(simulated_people::Error),
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

impl From<simulated_people::Error> for Error {
    fn from(error: simulated_people::Error) -> Self {
        match error {
            simulated_people::Error::Value { what, got, wanted } => {
                Self::Value { what, got, wanted }
            }
            error => Self::People(error),
        }
    }
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
