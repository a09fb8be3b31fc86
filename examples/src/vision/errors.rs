//! The library's errors in the programs' words: with the file that they are about, and with the
//! option that would be right.

use std::path::Path;

use vision_models::{Checkpoint, Error};

use super::choices::Accepted;

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
        Error::Setting { name, value, expected } => {
            anyhow::anyhow!("--{name} {value}: give {expected}")
        }
        error => error.into(),
    }
}

/// Opens a checkpoint.
///
/// # Errors
/// With the file's name.
pub fn open_checkpoint(path: &Path) -> anyhow::Result<Checkpoint> {
    Checkpoint::open(path).map_err(|error| in_file(path, error))
}

/// An error of loading a network from a checkpoint. One that holds another network says which, and
/// what to try.
pub fn of_weights(path: &Path, accepted: Accepted, error: Error) -> anyhow::Error {
    match error {
        Error::Weights { found: Some(found), .. } => {
            anyhow::anyhow!("{}: this is a {found}: {}", path.display(), accepted.hint(found))
        }
        Error::Threads { .. } => error.into(),
        error => in_file(path, error),
    }
}
