//! Errors of files in MCAP.

use crate::error::RecordingError;

/// Reason why a file cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum McapError {
    /// It is not an MCAP file, or it is truncated.
    #[error(
        "not a whole MCAP file: {0}; record it again, or recover what is there with `mcap recover`"
    )]
    Mcap(#[from] mcap::McapError),
    /// A part of the file claims to be larger than in any program's file.
    #[error("a chunk claims to hold {claimed} bytes; the file is broken")]
    Chunk {
        /// The claimed size.
        claimed: u64,
    },
    /// A chunk has an unsupported compression.
    #[error(
        "a chunk is compressed by {found:?}, and zstd alone is read here; convert the file with \
         `mcap compress --compression zstd IN -o OUT`"
    )]
    Compression {
        /// The name of the compression.
        found: String,
    },
    /// A record ends before its claimed length.
    #[error("a {what} record says that {needed} bytes follow, and {left} do; the file is broken")]
    Record {
        /// Name of the record.
        what: &'static str,
        /// Claimed length (bytes).
        needed: usize,
        /// Available length (bytes).
        left: usize,
    },
    /// A message belongs to no channel.
    #[error(
        "a message is of channel {channel}, which the file does not describe; the file is broken"
    )]
    Channel {
        /// Number of the channel.
        channel: u64,
    },
    /// The file has other contents.
    #[error("the file holds no recording: {missing} is missing; its topics are {topics}")]
    NoRecording {
        /// The part of a recording that is missing.
        missing: &'static str,
        /// The topics of the file.
        topics: String,
    },
    /// The messages of the recording have another schema.
    #[error(
        "messages of /percepts have the schema {found}, expected moca.Percept; convert the file with the program that wrote it"
    )]
    Schema {
        /// Their schema.
        found: String,
    },
    /// Frames are missing.
    #[error("the file holds {found} frames, its metadata says {expected}; it was cut or edited")]
    Frames {
        /// Number of frames in the file.
        found: u64,
        /// Number of frames that there should be.
        expected: u64,
    },
    /// The input is not a recording.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// A recording was truncated within a character.
    #[error(
        "text that is not UTF-8: {0}; the end of a recording was cut within a letter, or the file is broken"
    )]
    NotText(#[from] std::string::FromUtf8Error),
    /// A message cannot be written as JSON.
    #[error("a message that cannot be written: {0}")]
    Json(#[from] serde_json::Error),
}
