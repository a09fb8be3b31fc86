//! The ending of a program, and its exit status.

use serde::{Deserialize, Serialize};

/// The ending of a run without an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Ending {
    /// The work is complete.
    Complete,
    /// The run was interrupted; its results so far are printed and kept.
    Partial,
    /// The work is done, and its result is a failure.
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
