//! Errors of checkpoint files. A rejected file is not used at all.

use std::fmt::Display;

use crate::error::Error;
use crate::excerpt::Excerpt;

/// Returns the error for a place in a file.
pub(crate) fn refused(place: impl Display, problem: impl Display) -> Error {
    Error::Checkpoint { place: place.to_string(), problem: problem.to_string() }
}

/// Returns the error for a part of the file that exceeds a limit of this reader.
pub(super) fn beyond(what: &str, value: u64, limit: u64) -> Error {
    refused(what, format_args!("{value}, more than the {limit} that are accepted"))
}

/// Returns the error for a file that ends too early, or a length in it that is too large (bytes).
pub(super) fn truncated(what: &str, position: u64, needed: u64, available: u64) -> Error {
    refused(
        format_args!("{what} at byte {position}"),
        format_args!(
            "it takes {needed} bytes, but {available} are left: the file is cut off or corrupted"
        ),
    )
}

/// Returns the error for a byte of a pickle.
pub(super) fn in_pickle(position: u64, problem: impl Display) -> Error {
    refused(format_args!("pickle, byte {position}"), problem)
}

/// Returns the error for a tensor.
pub(super) fn of_tensor(name: &str, problem: impl Display) -> Error {
    refused(format_args!("tensor \"{}\"", Excerpt(name)), problem)
}

/// Returns the error for a storage.
pub(super) fn of_storage(key: &str, problem: impl Display) -> Error {
    refused(format_args!("storage \"{}\"", Excerpt(key)), problem)
}

/// Returns the error for a file from a big-endian machine.
pub(super) fn big_endian() -> Error {
    refused(
        "byte order",
        "the machine that wrote the file was big-endian: only little-endian ones are read",
    )
}
