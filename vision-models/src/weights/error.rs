//! What can be wrong with a checkpoint file. Nothing of a file that is refused is used.

use std::fmt::Display;

use crate::error::Error;
use crate::excerpt::Excerpt;

/// What is wrong at a place in a file.
pub(crate) fn refused(place: impl Display, problem: impl Display) -> Error {
    Error::Checkpoint { place: place.to_string(), problem: problem.to_string() }
}

/// A part of the file beyond what this reader takes.
pub(super) fn beyond(what: &str, value: u64, limit: u64) -> Error {
    refused(what, format_args!("{value}, more than the {limit} that are accepted"))
}

/// A file that ends too early, or a length in it that is too large (bytes).
pub(super) fn truncated(what: &str, position: u64, needed: u64, available: u64) -> Error {
    refused(
        format_args!("{what} at byte {position}"),
        format_args!(
            "it takes {needed} bytes, but {available} are left: the file is cut off or corrupted"
        ),
    )
}

/// What is wrong at a byte of a pickle.
pub(super) fn in_pickle(position: u64, problem: impl Display) -> Error {
    refused(format_args!("pickle, byte {position}"), problem)
}

/// What is wrong with a tensor.
pub(super) fn of_tensor(name: &str, problem: impl Display) -> Error {
    refused(format_args!("tensor \"{}\"", Excerpt(name)), problem)
}

/// What is wrong with a storage.
pub(super) fn of_storage(key: &str, problem: impl Display) -> Error {
    refused(format_args!("storage \"{}\"", Excerpt(key)), problem)
}

/// A file of a big-endian machine.
pub(super) fn big_endian() -> Error {
    refused(
        "byte order",
        "the machine that wrote the file was big-endian: only little-endian ones are read",
    )
}
