//! A whole soak: its episodes, all of them or some.

use std::collections::BTreeMap;
use std::ops::ControlFlow;

use moca_model::moca;
use rand::{Rng, RngCore};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

use super::episode::Episode;
use super::episode_result::EpisodeResult;
use super::monitor::Monitor;
use super::summary::Summary;
use super::tick_times::TickTimes;
use crate::error::Error;
use crate::plant::PlantSettings;

/// Ticks of an episode.
const EPISODE: std::ops::Range<u64> = 4_000..25_000;

/// Episodes until a number of ticks is reached. The same seed gives the same ticks.
#[derive(Clone, Debug)]
pub struct Soak {
    seed: u64,
    ticks: u64,
    robot: PlantSettings,
}

/// An episode to run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EpisodePlan {
    /// Number of the episode, from 0.
    pub number: u64,
    /// Seed of everything random in it.
    pub seed: u64,
    /// Number of ticks.
    pub ticks: u64,
}

impl Soak {
    /// A soak of `ticks` milliseconds.
    ///
    /// # Errors
    /// [`Error::Value`] for no ticks at all.
    pub fn new(seed: u64, ticks: u64) -> Result<Self, Error> {
        if ticks == 0 {
            return Err(Error::Value { what: "ticks", got: 0.0, wanted: "at least 1" });
        }
        Ok(Self { seed, ticks, robot: PlantSettings::default() })
    }

    /// The same with another robot, but for the goal, which each episode draws, and with room for rows of
    /// the shapes that the soak makes.
    #[must_use]
    pub fn with_robot(mut self, robot: PlantSettings) -> Self {
        self.robot = robot;
        self
    }

    /// The episodes. They depend on the seed alone, so that each may run anywhere.
    pub fn episodes(&self) -> Vec<EpisodePlan> {
        let mut draw = ChaCha8Rng::seed_from_u64(self.seed);
        let (mut plans, mut planned) = (Vec::new(), 0);
        for number in 0.. {
            if planned >= self.ticks {
                break;
            }
            let (seed, length) = (draw.next_u64(), draw.random_range(EPISODE));
            let ticks = length.min(self.ticks - planned);
            plans.push(EpisodePlan { number, seed, ticks });
            planned += ticks;
        }
        plans
    }

    /// Runs all episodes; `each` is told how many ticks are done, after each thousand, and may end it there.
    ///
    /// # Errors
    /// A controller that refuses its settings or what it measures.
    pub fn run(&self, each: impl FnMut(u64) -> ControlFlow<()>) -> Result<Summary, Error> {
        let (results, times) = self.run_episodes(&self.episodes(), each)?;
        Ok(Summary::of(&results, &times))
    }

    /// Runs some episodes; what each came to, by its number, and how long the ticks took.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub fn run_episodes(
        &self,
        episodes: &[EpisodePlan],
        mut each: impl FnMut(u64) -> ControlFlow<()>,
    ) -> Result<(BTreeMap<u64, EpisodeResult>, TickTimes), Error> {
        let model = moca()?;
        let (mut results, mut times) = (BTreeMap::new(), TickTimes::default());
        let (mut done, mut flow) = (0_u64, ControlFlow::Continue(()));
        for &EpisodePlan { number, seed, ticks } in episodes {
            if flow.is_break() {
                break;
            }
            let mut episode = Episode::new(&model, seed, &self.robot)?;
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
            let standing = episode.stillness.stillness();
            let Monitor { counts, ended, .. } = episode.monitor;
            let result = EpisodeResult { ticks: run, counts, ended, moving, standing, finding };
            results.insert(number, result);
        }
        Ok((results, times))
    }
}
