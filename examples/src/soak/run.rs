//! A whole soak: its episodes, all of them or those of a shard.

use std::collections::BTreeMap;
use std::ops::ControlFlow;

use anyhow::ensure;
use moca_model::moca;
use rand::{Rng, RngCore};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use serde::{Deserialize, Serialize};

use super::disturbance::Endings;
use super::episode::Episode;
use super::monitor::{Counts, Monitor};
use super::summary::Summary;
use super::tick_times::TickTimes;
use crate::settings::RobotSettings;
use crate::shards::{Merged, Part, Shard};
use moca_simulation::plant::Drive;

/// Ticks of an episode.
const EPISODE: std::ops::Range<u64> = 4_000..25_000;

/// Of the program, in files of shards.
pub const PROGRAM: &str = "soak";

/// Episodes until a number of ticks is reached. The same seed gives the same ticks.
#[derive(Clone, Debug)]
pub struct Soak {
    seed: u64,
    ticks: u64,
    drive: Drive,
    settings: RobotSettings,
    shard: Shard,
}

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

/// What an episode came to.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EpisodeResult {
    /// Ticks run.
    pub ticks: u64,
    /// Ticks with something wrong.
    pub counts: Counts,
    /// How disturbances have ended.
    pub ended: Endings,
    /// Ticks in which the robot moves.
    pub moving: u64,
    /// The first tick with something wrong, in words.
    pub finding: Option<String>,
}

/// What a soak, or a shard of it, has computed.
pub type SoakPart = Part<Job, EpisodeResult, TickTimes>;

/// An episode to run.
struct Plan {
    case: u64,
    seed: u64,
    ticks: u64,
}

impl Soak {
    /// A soak of `ticks` milliseconds.
    ///
    /// # Errors
    /// No ticks at all.
    pub fn new(seed: u64, ticks: u64) -> anyhow::Result<Self> {
        ensure!(ticks > 0, "0 ticks are no soak; give at least 1");
        let (drive, settings) = (Drive::default(), RobotSettings::default());
        Ok(Self { seed, ticks, drive, settings, shard: Shard::WHOLE })
    }

    /// The same, with a robot that follows velocities exactly and at once.
    #[must_use]
    pub fn kinematic(mut self) -> Self {
        self.drive = Drive::Kinematic;
        self
    }

    /// The same with other settings, but for the goal, which each episode draws, and with room for rows of
    /// the shapes that the soak makes.
    #[must_use]
    pub fn with_settings(mut self, settings: RobotSettings) -> Self {
        self.settings = settings;
        self
    }

    /// The same, but only the episodes of a shard.
    #[must_use]
    pub fn sharded(mut self, shard: Shard) -> Self {
        self.shard = shard;
        self
    }

    /// Ticks of the episodes that are run.
    pub fn ticks(&self) -> u64 {
        self.plan().0.iter().map(|plan| plan.ticks).sum()
    }

    /// Runs it; `each` is told how many ticks are done, after each thousand, and may end it there.
    ///
    /// # Errors
    /// A controller that refuses its settings or what it measures.
    pub fn run(&self, each: impl FnMut(u64) -> ControlFlow<()>) -> anyhow::Result<Summary> {
        Ok(summary(&self.part(each)?))
    }

    /// The same; what its shard has computed.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub fn part(&self, mut each: impl FnMut(u64) -> ControlFlow<()>) -> anyhow::Result<SoakPart> {
        let model = moca()?;
        let (plans, cases) = self.plan();
        let (mut results, mut times) = (BTreeMap::new(), TickTimes::new());
        let (mut done, mut flow) = (0_u64, ControlFlow::Continue(()));
        for Plan { case, seed, ticks } in plans {
            if flow.is_break() {
                break;
            }
            let mut episode = Episode::new(&model, seed, self.drive, &self.settings)?;
            let (mut run, mut moving, mut finding) = (0, 0, None);
            while run < ticks && flow.is_continue() {
                if let Some(tick_us) = episode.step()? {
                    times.push(tick_us);
                }
                finding = finding.or(episode.first_wrong());
                moving += u64::from(episode.moves());
                run += 1;
                done += 1;
                if done.is_multiple_of(1000) {
                    flow = each(done);
                }
            }
            let Monitor { counts, ended, .. } = episode.monitor;
            results.insert(case, EpisodeResult { ticks: run, counts, ended, moving, finding });
        }
        let job = Job {
            seed: self.seed,
            ticks: self.ticks,
            kinematic: self.drive == Drive::Kinematic,
            settings: self.settings.to_toml()?,
        };
        Ok(Part { program: PROGRAM.to_owned(), job, shard: self.shard, cases, results, times })
    }

    /// The episodes of the shard, and how many there are in all. They depend on the seed alone, so that
    /// every shard knows its own.
    fn plan(&self) -> (Vec<Plan>, u64) {
        let mut draw = ChaCha8Rng::seed_from_u64(self.seed);
        let (mut plans, mut planned, mut case) = (Vec::new(), 0, 0);
        while planned < self.ticks {
            let (seed, length) = (draw.next_u64(), draw.random_range(EPISODE));
            let ticks = length.min(self.ticks - planned);
            if self.shard.holds(case) {
                plans.push(Plan { case, seed, ticks });
            }
            planned += ticks;
            case += 1;
        }
        (plans, case)
    }
}

/// What a soak, or a shard of it, found.
pub fn summary(part: &SoakPart) -> Summary {
    Summary::of(part.results.iter().map(|(case, result)| (*case, result)), &part.times)
}

/// What all shards of a soak found.
pub fn merged_summary(merged: &Merged<Job, EpisodeResult, TickTimes>) -> Summary {
    let mut times = TickTimes::new();
    for of_shard in &merged.times {
        times += of_shard;
    }
    Summary::of((0..).zip(&merged.results), &times)
}
