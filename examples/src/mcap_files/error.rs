//! What can be wrong with a file in MCAP.

use crate::recording::RecordingError;

/// Why a file cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum McapFileError {
    /// It is no MCAP, or it is cut off.
    #[error(
        "not a whole MCAP file: {0}; record it again, or recover what is there with `mcap recover`"
    )]
    Mcap(#[from] mcap::McapError),
    /// A part of the file claims to be larger than any program makes them.
    #[error("a chunk claims to hold {claimed} bytes; the file is broken")]
    Chunk {
        /// Its claim.
        claimed: u64,
    },
    /// It is a file of something else.
    #[error("the file holds no recording: {missing} is missing; its topics are {topics}")]
    NoRecording {
        /// What a recording has.
        missing: &'static str,
        /// What the file has.
        topics: String,
    },
    /// The messages of the recording are of another kind.
    #[error(
        "messages of /percepts have the schema {found}, expected moca.Percept; convert the file with the program that wrote it"
    )]
    Schema {
        /// The schema that they have.
        found: String,
    },
    /// Frames are missing.
    #[error("the file holds {found} frames, its metadata says {expected}; it was cut or edited")]
    Frames {
        /// How many there are.
        found: u64,
        /// How many there should be.
        expected: u64,
    },
    /// What is to be converted is no recording.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// A recording that was cut within a letter.
    #[error("the end of the recording is no text: {0}; take the cut line away")]
    NotText(#[from] std::string::FromUtf8Error),
    /// A message that is not JSON.
    #[error("a message that cannot be written: {0}")]
    Json(#[from] serde_json::Error),
    /// The robot's kinematics refuse a configuration.
    #[error(transparent)]
    Robot(#[from] moca_model::whole_body::Error),
}
