//! Reading a map that was saved.

use std::path::Path;

use anyhow::Context;
use ergo_map::{ErgonomicsMap, Error};

/// Reads the map that `ergo_map` has saved in this file.
///
/// # Errors
/// A file that cannot be read, or holds no whole map; both name the file.
pub fn read_map(path: impl AsRef<Path>) -> anyhow::Result<ErgonomicsMap> {
    let path = path.as_ref();
    let shown = path.display();
    match ErgonomicsMap::load(path) {
        Err(Error::Io { kind, .. }) => {
            Err(std::io::Error::from(kind)).with_context(|| format!("cannot read {shown}"))
        }
        read => read.with_context(|| shown.to_string()),
    }
}
