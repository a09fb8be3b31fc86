//! Opens checkpoints, with the file's name in errors.

use std::path::Path;

use vision_models::{Checkpoint, NetworkKind, file::Excerpt};

use crate::{
    error::Error,
    watch::{Watch, warn},
};

/// Largest number of left-out tensors that are named.
const SHOWN: usize = 8;

/// Opens a checkpoint of a network. A warning names the tensors that are not part of it.
///
/// # Errors
/// Names the file that cannot be used.
pub fn open_weights(path: &Path, watch: &mut Watch<'_>) -> Result<Checkpoint, Error> {
    let checkpoint = open_checkpoint(path)?;
    let network = NetworkKind::of(&checkpoint);
    let left_out = network.and_then(|kind| kind.left_out(&checkpoint)).unwrap_or_default();
    let unread = checkpoint.unread().iter().chain(&left_out);
    let mut names: Vec<String> = unread.map(|name| Excerpt(name).to_string()).collect();
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
/// Names the file that cannot be used.
pub fn open_checkpoint(path: &Path) -> Result<Checkpoint, Error> {
    Checkpoint::open(path).map_err(Error::content(path))
}
