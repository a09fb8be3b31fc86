//! Ergonomics maps.

use std::io::Write;
use std::sync::{LazyLock, OnceLock};

use ergo_map::{ErgonomicsMap, MapOptions, Person};

use super::keep;

/// The map that `follow` builds for a person of 1.75 m.
pub(crate) fn average_map() -> &'static ErgonomicsMap {
    static MAP: LazyLock<ErgonomicsMap> = LazyLock::new(|| build(&MapOptions::default()));
    &MAP
}

/// A coarse map of the same person.
pub(crate) fn coarse_map() -> &'static ErgonomicsMap {
    static MAP: LazyLock<ErgonomicsMap> =
        LazyLock::new(|| build(&MapOptions { spacing: 0.1, ..MapOptions::default() }));
    &MAP
}

/// The file of the coarse map.
pub(crate) fn coarse_map_file() -> &'static str {
    static PATH: OnceLock<String> = OnceLock::new();
    PATH.get_or_init(|| {
        keep("coarse.ergomap", |mut file| file.write_all(&coarse_map().to_bytes()).unwrap())
    })
}

fn build(options: &MapOptions) -> ErgonomicsMap {
    ErgonomicsMap::build(&Person::average(), options, None).unwrap()
}
