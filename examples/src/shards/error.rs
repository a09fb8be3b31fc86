//! Errors of shards.

use std::{io, path::PathBuf};

/// Reason why shards cannot be read or merged.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ShardError {
    /// A shard is not of the form I/N.
    #[error("\"{found}\" is no shard; give I/N with I from 1 to N, as 2/4 for the second of four")]
    Form {
        /// The given text.
        found: String,
    },
    /// A file cannot be read.
    #[error("cannot read {path}: {source}", path = path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// A file does not contain a shard, or is cut off.
    #[error("{path} is not the whole file of a shard: {reason}; compute this shard again", path = path.display())]
    Broken {
        /// The file.
        path: PathBuf,
        /// Fault of the file.
        reason: String,
    },
    /// There are no files.
    #[error("there is nothing to merge; give the files of all shards")]
    Nothing,
    /// The shards are of different runs.
    #[error("shard {shard} is of another run than shard {first}: {what}; merge shards of one run")]
    Different {
        /// The shard that differs.
        shard: String,
        /// The first of the files.
        first: String,
        /// Name of the property that differs.
        what: &'static str,
    },
    /// A shard is given twice.
    #[error("shard {shard} is there twice; give the file of each shard once")]
    Twice {
        /// The shard.
        shard: String,
    },
    /// Some shards are missing.
    #[error("of {of} shards these are missing: {missing}; compute them and merge again")]
    Missing {
        /// The missing shards as I/N.
        missing: String,
        /// The number of all shards.
        of: u64,
    },
    /// A shard lacks cases, or has others.
    #[error("shard {shard} holds {got} cases, expected {wanted}; compute it again")]
    Cases {
        /// The shard.
        shard: String,
        /// The number of its cases in the file.
        got: usize,
        /// The number of its own cases.
        wanted: usize,
    },
}
