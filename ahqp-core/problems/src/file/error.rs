//! Errors of a set of problems.

use std::io;

/// Reason why a set cannot be read: the place, what was found, and what would be valid. Lines count
/// from 1.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum HqpError {
    /// Reading failed.
    #[error("line {line}: cannot read on: {source}")]
    Io {
        /// Line at which reading failed.
        line: usize,
        /// Error of the operating system.
        source: io::Error,
    },
    /// The text ends too early.
    #[error("line {line}: the file ends where {wanted} should stand; are its counts right?")]
    Ended {
        /// The last line.
        line: usize,
        /// The expected item.
        wanted: String,
    },
    /// Another word than the format requires.
    #[error("line {line}: `{got}` stands where {wanted} should; are the counts before it right?")]
    Unexpected {
        /// The line.
        line: usize,
        /// The word that was found.
        got: String,
        /// The expected word.
        wanted: String,
    },
    /// An invalid number, or a count or an index outside its range.
    #[error("line {line}: {what} is `{got}`; it must be {wanted}")]
    Value {
        /// The line.
        line: usize,
        /// Name of the quantity.
        what: &'static str,
        /// The text that was found.
        got: String,
        /// The allowed range.
        wanted: String,
    },
    /// A word that is much too long.
    #[error("line {line}: a word is longer than {limit} bytes; is this a text file?")]
    WordTooLong {
        /// The line.
        line: usize,
        /// Longest word that is read, in bytes.
        limit: usize,
    },
    /// The problem was refused by `ahqp-core`.
    #[error(transparent)]
    Problem(#[from] ahqp_core::Error),
}
