//! What can be wrong with a set of problems.

use std::io;

/// Why a set cannot be read: where, what was found, and what would be right. Lines count from 1.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum HqpError {
    /// The system cannot read on.
    #[error("line {line}: cannot read on: {source}")]
    Io {
        /// The line that failed.
        line: usize,
        /// What the system says.
        source: io::Error,
    },
    /// The text ends too early.
    #[error("line {line}: the file ends where {wanted} should stand; are its counts right?")]
    Ended {
        /// The last line.
        line: usize,
        /// What should come next.
        wanted: String,
    },
    /// Another word than the format asks for.
    #[error("line {line}: `{got}` stands where {wanted} should; are the counts before it right?")]
    Unexpected {
        /// The line.
        line: usize,
        /// What does.
        got: String,
        /// What should stand there.
        wanted: String,
    },
    /// A number that is none, or a count or an index outside its range.
    #[error("line {line}: {what} is `{got}`; it must be {wanted}")]
    Value {
        /// The line.
        line: usize,
        /// The quantity.
        what: &'static str,
        /// What stands there.
        got: String,
        /// What would be right.
        wanted: String,
    },
    /// A word that is far too long.
    #[error("line {line}: a word is longer than {limit} bytes; is this a text file?")]
    WordTooLong {
        /// The line.
        line: usize,
        /// The most that is read.
        limit: usize,
    },
    /// The problem is refused by the solver's own types.
    #[error(transparent)]
    Problem(#[from] ahqp_core::Error),
}
