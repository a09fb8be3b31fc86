//! How a program ends, and the exit status that says so.

use serde::{Deserialize, Serialize};

/// What becomes of a run that did not fail with an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Ending {
    /// All that was asked for is done.
    Complete,
    /// The run was interrupted; what it has is printed and kept.
    Partial,
    /// The work is done, and what it found is a failure.
    Failed,
}

/// Everything is done.
pub(super) const DONE: u8 = 0;
/// An error, or a result that is a failure.
pub(super) const FAILURE: u8 = 1;
/// Standard output cannot be written, for example because the disk is full (`EX_IOERR`).
pub(super) const OUTPUT_FAILED: u8 = 74;
/// Standard output was closed by its reader: 128 and the number of the signal SIGPIPE.
pub(super) const OUTPUT_CLOSED: u8 = 141;

/// The end of every `--help`.
pub(super) const HELP: &str = "Exit status: 0 done, 1 failed, 2 wrong options, 74 standard output \
                               cannot be written, 130 (Ctrl-C) or 143 (terminated) interrupted, 141 \
                               standard output was closed.";
