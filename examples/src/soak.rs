//! A soak in shards, for the programs `soak` and `merge`.

use std::ops::ControlFlow;

use moca_simulation::Error;
use moca_simulation::plant::Drive;
use moca_simulation::soak::{EpisodePlan, EpisodeResult, Soak, Summary, TickTimes};
use serde::{Deserialize, Serialize};

use crate::shards::{Merged, Part, Shard};

/// Name of the program in shard files.
pub const PROGRAM: &str = "soak";

/// The job that all shards of a soak share.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Job {
    seed: u64,
    ticks: u64,
    kinematic: bool,
    /// Settings as the text of a file, since JSON has no infinity.
    settings: String,
}

/// The results of a soak, or of a shard of it.
pub type SoakPart = Part<Job, EpisodeResult, TickTimes>;

impl Job {
    /// Creates the job of a soak of this number of ticks, with the text of a settings file.
    pub fn new(seed: u64, ticks: u64, drive: Drive, settings: String) -> Self {
        Self { seed, ticks, kinematic: drive == Drive::Kinematic, settings }
    }
}

/// The episodes of a shard.
pub fn episodes(soak: &Soak, shard: Shard) -> Vec<EpisodePlan> {
    soak.episodes().into_iter().filter(|plan| shard.contains(plan.number)).collect()
}

/// Runs the episodes of a shard. `each` gets the number of finished ticks, and may end the run.
///
/// # Errors
/// Settings or measurements that the controller refuses.
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

/// The summary of all shards of a soak.
pub fn merged_summary(merged: Merged<Job, EpisodeResult, TickTimes>) -> Summary {
    let mut times = TickTimes::default();
    for of_shard in &merged.times {
        times += of_shard;
    }
    Summary::of(&(0..).zip(merged.results).collect(), &times)
}
