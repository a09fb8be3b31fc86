//! Reading a map that was saved.

use std::{fs::File, path::Path};

use anyhow::Context;
use ergo_map::ErgonomicsMap;

/// Reads the map that `ergo_map` has saved in this file.
///
/// # Errors
/// A file that cannot be read, or holds no whole map; both name the file.
pub fn read_map(path: impl AsRef<Path>) -> anyhow::Result<ErgonomicsMap> {
    let path = path.as_ref();
    let shown = path.display();
    // The system's own words for why a file cannot be opened; the map's error only has their kind.
    File::open(path).with_context(|| format!("cannot read {shown}"))?;
    ErgonomicsMap::load(path).with_context(|| shown.to_string())
}
