//! The file that describes a trained model: JSON with the version of its format.

use std::{io::ErrorKind, path::Path};

use serde::{Serialize, de::DeserializeOwned};

use vision_models::file::read_text;

use crate::{error::Error, file::write_whole};

/// Largest size (bytes): the names of some hundred thousand images.
const LARGEST: u64 = 64 << 20;

/// Writes a description, completely or not at all.
///
/// # Errors
/// Names the place that cannot be written.
pub fn write(path: &Path, description: &impl Serialize) -> Result<(), Error> {
    let text = serde_json::to_string_pretty(description);
    let text = text.map_err(|error| Error::write(path)(error.into()))? + "\n";
    write_whole(path, text.as_bytes())
}

/// Reads a description.
///
/// # Errors
/// Names the file if it cannot be read, is too long, or is no description.
pub fn read<T: DeserializeOwned>(path: &Path) -> Result<T, Error> {
    let text = read_text(path, LARGEST).map_err(|error| match error.kind() {
        ErrorKind::FileTooLarge => {
            let most = LARGEST >> 20;
            let found = format!("a model's description takes at most {most} MiB");
            Error::at(path.display(), found)
        }
        _ => Error::read(path)(error),
    })?;
    serde_json::from_str(&text).map_err(|error| Error::at(path.display(), error))
}

/// Checks the version of the format.
///
/// # Errors
/// An error if it is not the known one.
pub fn check_version(path: &Path, version: u32, known: u32) -> Result<(), Error> {
    if version == known {
        return Ok(());
    }
    let found = format!("version {version} of the format, of which {known} is known");
    Err(Error::at(path.display(), found))
}
