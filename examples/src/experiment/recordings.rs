//! Files of recordings in place of simulated people.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, Result};
use human_perception::learning::digest::Digest;
use moca_simulation::experiment::{Needs, Recorded};
use percept_recording::{IfPartial, Reader, Recording};

use crate::program::read_bytes;

/// Largest recording that is played: some days (bytes).
const LARGEST: u64 = 1 << 30;

/// Reads recordings, checks that an experiment can play them, and returns each with the digest of its file.
///
/// # Errors
/// The name of a file that cannot be read, is cut off or interrupted, or does not contain what is needed.
pub(super) fn read_all(paths: &[PathBuf], needs: Needs) -> Result<Vec<(Arc<Recorded>, String)>> {
    let read = |path: &PathBuf| read(path, needs).with_context(|| path.display().to_string());
    paths.iter().map(read).collect()
}

fn read(path: &Path, needs: Needs) -> Result<(Arc<Recorded>, String)> {
    let bytes = read_bytes(path, LARGEST)?;
    let recording = Recording::read(Reader::new(bytes.as_slice())?, IfPartial::Refuse)?;
    let recorded = Recorded::new(recording, needs)?;
    Ok((Arc::new(recorded), Digest::of_bytes(&bytes).to_string()))
}
