//! The file that describes a trained model: JSON with the version of its format.

use std::{io::ErrorKind, path::Path};

use anyhow::{Context, Result, anyhow, ensure};
use serde::{Serialize, de::DeserializeOwned};

use crate::program::{OutputFile, read_text};

/// The most that one may take (bytes): the names of some hundred thousand images.
const LARGEST: u64 = 64 << 20;

/// Writes one, whole or not at all.
///
/// # Errors
/// With the place that cannot be written.
pub fn write(path: &Path, description: &impl Serialize) -> Result<()> {
    let text = serde_json::to_string_pretty(description)? + "\n";
    OutputFile::write_whole(path, text.as_bytes())?;
    Ok(())
}

/// Reads one.
///
/// # Errors
/// With the file's name: it cannot be read, is too long, or is no description.
pub fn read<T: DeserializeOwned>(path: &Path) -> Result<T> {
    let named = || path.display().to_string();
    let text = read_text(path, LARGEST).map_err(|error| match error.kind() {
        ErrorKind::FileTooLarge => {
            let most = LARGEST >> 20;
            anyhow!("{}: a model's description takes at most {most} MiB", named())
        }
        _ => anyhow::Error::new(error).context(named()),
    })?;
    serde_json::from_str(&text).with_context(named)
}

/// Checks the version of the format.
///
/// # Errors
/// If it is not the known one.
pub fn check_version(path: &Path, version: u32, known: u32) -> Result<()> {
    ensure!(
        version == known,
        "{}: version {version} of the format, of which {known} is known",
        path.display()
    );
    Ok(())
}
