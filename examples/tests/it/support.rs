//! Data that the tests of programs share.

use std::{fs::File, path::PathBuf};

mod disk;
mod frames;
mod maps;
mod networks;
mod npy;
mod pictures;
mod run;

pub(crate) use disk::SmallDisk;
pub(crate) use frames::small_frames;
pub(crate) use maps::{average_map, coarse_map, coarse_map_file};
pub(crate) use networks::{resnet18, simple_baseline, slow_only_r18};
pub(crate) use npy::{read_npy, write_npy};
pub(crate) use pictures::{png_that_claims, save_picture};
pub(crate) use run::{Ran, Runs, signal};

/// Writes a file into the folder for test files and returns its path. It may be read at any time.
fn keep(name: &str, write: impl FnOnce(&File)) -> String {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let unfinished = tempfile::NamedTempFile::new_in(&folder).unwrap();
    write(unfinished.as_file());
    let path = folder.join(name);
    unfinished.persist(&path).unwrap();
    path.to_str().unwrap().to_owned()
}

/// Number of random cases: AHQP_CASES, or the default.
pub(crate) fn cases(default: u64) -> u64 {
    std::env::var("AHQP_CASES").ok().and_then(|value| value.parse().ok()).unwrap_or(default)
}
