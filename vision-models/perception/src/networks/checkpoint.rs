//! Checkpoints, with the names of what they are about.

use std::path::Path;

use vision_models::{Checkpoint, NetworkKind};

use crate::{
    error::Error,
    printable::printable,
    watch::{Watch, warn},
};

/// How many tensors are named that are left out.
const SHOWN: usize = 8;

/// Opens a checkpoint of a network. What stands among the weights and is no part of it is named by a warning.
///
/// # Errors
/// Errors carry the file's name.
pub fn open_weights(path: &Path, watch: &mut Watch<'_>) -> Result<Checkpoint, Error> {
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
        warn(
            watch,
            format_args!("{shown}: left out, as it is no part of the network: {names}{more}"),
        );
    }
    Ok(checkpoint)
}

/// Opens a checkpoint.
///
/// # Errors
/// Errors carry the file's name.
pub fn open_checkpoint(path: &Path) -> Result<Checkpoint, Error> {
    Checkpoint::open(path).map_err(Error::content(path))
}
