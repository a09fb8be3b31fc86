//! A soak in shards, for the programs `soak` and `merge`.

use std::ops::ControlFlow;

use moca_simulation::Error;
use moca_simulation::plant::Drive;
use moca_simulation::soak::{EpisodePlan, EpisodeResult, Soak, Summary, TickTimes};
use serde::{Deserialize, Serialize};

use crate::shards::{Merged, Part, Shard};

/// Name of the program, in files of shards.
pub const PROGRAM: &str = "soak";

/// What all shards of a soak share.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Job {
    seed: u64,
    ticks: u64,
    kinematic: bool,
    /// As in a file of settings: JSON has no infinity.
    settings: String,
}

/// What a soak, or a shard of it, has computed.
pub type SoakPart = Part<Job, EpisodeResult, TickTimes>;

impl Job {
    /// A soak of so many ticks, with the text of a file of settings.
    pub fn new(seed: u64, ticks: u64, drive: Drive, settings: String) -> Self {
        Self { seed, ticks, kinematic: drive == Drive::Kinematic, settings }
    }
}

/// The episodes of a shard.
pub fn episodes(soak: &Soak, shard: Shard) -> Vec<EpisodePlan> {
    soak.episodes().into_iter().filter(|plan| shard.holds(plan.number)).collect()
}

/// Runs the episodes of a shard; `each` is told how many ticks are done, and may end it there.
///
/// # Errors
/// A controller that refuses its settings or what it measures.
pub fn run(
    soak: &Soak,
    job: Job,
    shard: Shard,
    each: impl FnMut(u64) -> ControlFlow<()>,
) -> Result<SoakPart, Error> {
    let (results, times) = soak.run_episodes(&episodes(soak, shard), each)?;
    let cases = soak.episodes().len() as u64;
    Ok(Part { program: PROGRAM.to_owned(), job, shard, cases, results, times })
}

/// What all shards of a soak found.
pub fn merged_summary(merged: Merged<Job, EpisodeResult, TickTimes>) -> Summary {
    let mut times = TickTimes::default();
    for of_shard in &merged.times {
        times += of_shard;
    }
    Summary::of(&(0..).zip(merged.results).collect(), &times)
}
