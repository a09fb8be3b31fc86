//! What can be wrong with shards.

use std::{io, path::PathBuf};

/// Why shards cannot be read or merged.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ShardError {
    /// Not of the form I/N.
    #[error("\"{found}\" is no shard; give I/N with I from 1 to N, as 2/4 for the second of four")]
    Form {
        /// What was given.
        found: String,
    },
    /// A file that cannot be read.
    #[error("cannot read {path}: {source}", path = path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A file that holds no shard, or is cut off.
    #[error("{path} is not the whole file of a shard: {reason}; compute this shard again", path = path.display())]
    Broken {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// No files at all.
    #[error("there is nothing to merge; give the files of all shards")]
    Nothing,
    /// Shards of different runs.
    #[error("shard {shard} is of another run than shard {first}: {what}; merge shards of one run")]
    Different {
        /// The one that differs.
        shard: String,
        /// The first of the files.
        first: String,
        /// What differs.
        what: &'static str,
    },
    /// A shard that came twice.
    #[error("shard {shard} is there twice; give the file of each shard once")]
    Twice {
        /// Which.
        shard: String,
    },
    /// Shards that are not there.
    #[error("of {of} shards these are missing: {missing}; compute them and merge again")]
    Missing {
        /// Which, as I/N.
        missing: String,
        /// How many there are in all.
        of: u64,
    },
    /// A shard without all of its cases, or with others.
    #[error("shard {shard} holds {found} cases, expected {expected}; compute it again")]
    Cases {
        /// Which.
        shard: String,
        /// How many it holds.
        found: usize,
        /// How many are its own.
        expected: usize,
    },
}
