//! Errors of keys and of loops in lockstep.

use std::io;

use super::lockstep::PATIENCE;

/// Reason why a key cannot be used, or why a loop in lockstep ends.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The file of a key cannot be read.
    #[error("the key cannot be read: {0}")]
    KeyFile(#[source] io::Error),
    /// A key is too short or too long.
    #[error("{what} has {got} bytes, expected {wanted}")]
    Size {
        /// The key.
        what: &'static str,
        /// Number of bytes.
        got: usize,
        /// The right number, and how to make such a key.
        wanted: String,
    },
    /// The robot does not answer.
    #[error(
        "no packet for {} s; in lockstep the robot answers every hello and command with one, `MOn2` where it measures \
         nothing",
        PATIENCE.as_secs()
    )]
    Silent,
}
