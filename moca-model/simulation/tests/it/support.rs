//! Data that the tests share.

use std::sync::LazyLock;

use ergo_map::{ErgonomicsMap, MapOptions, Person};
use moca_simulation::people::{Walker, WalkerSettings};
use percept_recording::{Reader, Writer};
use vision_models::Percept;

/// The map of a person of 1.75 m.
pub(crate) fn average_map() -> &'static ErgonomicsMap {
    static MAP: LazyLock<ErgonomicsMap> = LazyLock::new(|| {
        ErgonomicsMap::build(&Person::average(), &MapOptions::default(), None).unwrap()
    });
    &MAP
}

/// The walk of the default settings as a recording.
pub(crate) fn recorded() -> Vec<Percept> {
    let walker = Walker::new(WalkerSettings::default()).unwrap();
    let mut writer = Writer::new(Vec::new(), &walker.header()).unwrap();
    walker.for_each(|percept| writer.write(&percept).unwrap());
    let text = writer.finish().unwrap();
    Reader::new(&text[..]).unwrap().map(Result::unwrap).collect()
}

/// Number of random cases: AHQP_CASES, or the default.
pub(crate) fn cases(default: u64) -> u64 {
    std::env::var("AHQP_CASES").ok().and_then(|value| value.parse().ok()).unwrap_or(default)
}
