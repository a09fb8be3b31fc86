//! What can be wrong with a file in MCAP.

use crate::RecordingError;

/// Why a file cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum McapError {
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
    /// A chunk is compressed in a way that is not read.
    #[error(
        "a chunk is compressed by {found:?}, and zstd alone is read here; convert the file with \
         `mcap compress --compression zstd IN -o OUT`"
    )]
    Compression {
        /// The name of the compression.
        found: String,
    },
    /// A record ends before what it says it holds.
    #[error("a {what} record says that {needed} bytes follow, and {left} do; the file is broken")]
    Record {
        /// Which record.
        what: &'static str,
        /// What it claims (bytes).
        needed: usize,
        /// What there is (bytes).
        left: usize,
    },
    /// A message of no channel.
    #[error(
        "a message is of channel {channel}, which the file does not describe; the file is broken"
    )]
    Channel {
        /// The channel's number.
        channel: u64,
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
    #[error(
        "text that is not UTF-8: {0}; the end of a recording was cut within a letter, or the file is broken"
    )]
    NotText(#[from] std::string::FromUtf8Error),
    /// A message that is not JSON.
    #[error("a message that cannot be written: {0}")]
    Json(#[from] serde_json::Error),
}
