//! A person's map, built with a progress bar until an interrupt, or read from a file.

use std::{fs::File, path::Path, sync::Arc};

use anyhow::Context;
use ergo_map::{ErgonomicsMap, MapOptions, Person};

use crate::program::Session;

/// Builds the map of a person with this number of threads, or with one for each core. Shows the progress.
///
/// # Errors
/// Invalid options; an interrupt.
pub fn build_map(
    session: &Session,
    person: &Person,
    options: &MapOptions,
    threads: Option<u16>,
) -> anyhow::Result<ErgonomicsMap> {
    let progress = Arc::new(session.open_progress("map of the person"));
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads.map_or(0, usize::from))
        .build()
        .context("cannot start the threads that build the map")?;
    let (person, options, shown) = (person.clone(), options.clone(), Arc::clone(&progress));
    let built = session.interrupt().wait_for(move || {
        let report = |done: usize, all: usize| {
            shown.set_length(all as u64);
            shown.set(done as u64);
        };
        pool.install(|| ErgonomicsMap::build(&person, &options, Some(&report)))
    });
    progress.finish();
    Ok(built?.map_err(ergo_report::Error::from)?)
}

/// Reads the map that `ergo_map` has saved in this file.
///
/// # Errors
/// The name of a file that cannot be read or does not contain a complete map.
pub fn read_map(path: impl AsRef<Path>) -> anyhow::Result<ErgonomicsMap> {
    let path = path.as_ref();
    let shown = path.display();
    // The system's own message says why a file cannot be opened. The map's error only has the kind.
    File::open(path).with_context(|| format!("cannot read {shown}"))?;
    ErgonomicsMap::load(path).with_context(|| shown.to_string())
}
