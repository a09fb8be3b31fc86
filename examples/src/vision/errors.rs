//! The library's errors in the programs' words: with the file that they are about, and with the
//! option that would be right.

use std::path::Path;

use vision_models::{Checkpoint, Error, NetworkKind};

use super::{choices::Accepted, tensor_name::printable};
use crate::program::warn;

/// How many tensors are named that are left out.
const SHOWN: usize = 8;

/// An error about a file, with the file's name.
pub fn in_file(path: &Path, error: Error) -> anyhow::Error {
    let shown = path.display();
    match error {
        // These have the name already.
        Error::File { .. } | Error::Image { .. } => error.into(),
        Error::NoFrames => anyhow::anyhow!("{shown}: no JPEG or PNG files"),
        error => anyhow::Error::new(error).context(shown.to_string()),
    }
}

/// An error about a value of the command line, with the option.
pub fn of_option(error: Error) -> anyhow::Error {
    match error {
        Error::Value { what, got, wanted } => anyhow::anyhow!("--{what} {got}: give {wanted}"),
        error => error.into(),
    }
}

/// Opens a checkpoint of a network. What stands among the weights and is no part of it is named on standard error.
///
/// # Errors
/// Errors carry the file's name.
pub fn open_weights(path: &Path) -> anyhow::Result<Checkpoint> {
    let checkpoint = open_checkpoint(path)?;
    let network = NetworkKind::of(&checkpoint);
    let left_out = network.and_then(|kind| kind.left_out(&checkpoint)).unwrap_or_default();
    let unread = checkpoint.unread().iter().chain(&left_out);
    let mut names: Vec<String> = unread.map(|name| printable(name)).collect();
    let more = names.len().saturating_sub(SHOWN);
    names.truncate(SHOWN);
    if !names.is_empty() {
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        let (shown, names) = (path.display(), names.join(", "));
        warn(format_args!("{shown}: left out, as it is no part of the network: {names}{more}"));
    }
    Ok(checkpoint)
}

/// Opens a checkpoint.
///
/// # Errors
/// Errors carry the file's name.
pub fn open_checkpoint(path: &Path) -> anyhow::Result<Checkpoint> {
    Checkpoint::open(path).map_err(|error| in_file(path, error))
}

/// An error of loading a network from a checkpoint. One that holds another network says which, and
/// what to try.
pub fn of_weights(path: &Path, accepted: Accepted, error: Error) -> anyhow::Error {
    match error {
        Error::Weights { found: Some(found), .. } => {
            let kind = NetworkKind::all().into_iter().find(|kind| kind.to_string() == found);
            let hint = kind.map(|kind| accepted.hint(kind)).unwrap_or_default();
            anyhow::anyhow!("{}: this is a {found}: {hint}", path.display())
        }
        Error::Threads { .. } => error.into(),
        error => in_file(path, error),
    }
}
