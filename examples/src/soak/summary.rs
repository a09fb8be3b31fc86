//! A whole soak, and what it found.

use std::fmt;
use std::ops::ControlFlow;

use anyhow::ensure;
use moca_model::moca;
use rand::{Rng, RngCore};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use serde::{Serialize, Serializer};

use super::disturbance::Endings;
use super::episode::Episode;
use super::monitor::Counts;
use super::tick_times::TickTimes;
use crate::plant::Drive;

/// Ticks of an episode.
const EPISODE: std::ops::Range<u64> = 4_000..25_000;

/// Episodes until a number of ticks is reached. The same seed gives the same ticks.
#[derive(Clone, Copy, Debug)]
pub struct Soak {
    seed: u64,
    ticks: u64,
    drive: Drive,
}

/// What a soak found.
#[derive(Clone, Debug)]
pub struct Summary {
    /// Ticks run.
    pub ticks: u64,
    /// Episodes begun.
    pub episodes: u64,
    /// Ticks with something wrong.
    pub counts: Counts,
    /// How disturbances have ended.
    pub ended: Endings,
    /// The first of them in each episode, in words.
    pub findings: Vec<String>,
    /// Ticks in which the robot moves.
    pub moving: u64,
    /// How long the controller took for a tick: median, and 99.9th percentile \[µs\].
    pub tick_us: [f64; 2],
}

/// The last line of the program's output.
#[derive(Serialize)]
struct Line {
    ticks: u64,
    infeasible: u64,
    not_finite: u64,
    limit_violations: u64,
    acceleration_violations: u64,
    jerk_violations: u64,
    torque_violations: u64,
    separation_violations: u64,
    discontinuities: u64,
    tick_us_p50: f64,
    tick_us_p999: f64,
    self_collisions: u64,
    person_caused: u64,
    contact: u64,
    moving: u64,
    episodes: u64,
    wrong_states: u64,
    disturbances: Endings,
}

impl Soak {
    /// A soak of `ticks` milliseconds.
    ///
    /// # Errors
    /// No ticks at all.
    pub fn new(seed: u64, ticks: u64) -> anyhow::Result<Self> {
        ensure!(ticks > 0, "0 ticks are no soak; give at least 1");
        Ok(Self { seed, ticks, drive: Drive::default() })
    }

    /// The same, with a robot that follows velocities exactly and at once.
    #[must_use]
    pub fn kinematic(mut self) -> Self {
        self.drive = Drive::Kinematic;
        self
    }

    /// Runs it; `each` is told how many ticks are done, after each thousand, and may end it there.
    ///
    /// # Errors
    /// A controller that refuses its settings or what it measures.
    pub fn run(self, mut each: impl FnMut(u64) -> ControlFlow<()>) -> anyhow::Result<Summary> {
        let model = moca()?;
        let mut draw = ChaCha8Rng::seed_from_u64(self.seed);
        let mut summary = Summary {
            ticks: 0,
            episodes: 0,
            counts: Counts::default(),
            ended: Endings::default(),
            findings: Vec::new(),
            moving: 0,
            tick_us: [0.0; 2],
        };
        let mut times = TickTimes::new();
        let mut flow = ControlFlow::Continue(());
        while summary.ticks < self.ticks && flow.is_continue() {
            let (seed, length) = (draw.next_u64(), draw.random_range(EPISODE));
            let mut episode = Episode::new(&model, seed, self.drive)?;
            for _ in 0..length.min(self.ticks - summary.ticks) {
                if let Some(tick_us) = episode.step()? {
                    times.push(tick_us);
                }
                if let Some(what) = episode.first_wrong() {
                    summary.findings.push(format!("episode {}, {what}", summary.episodes + 1));
                }
                summary.moving += u64::from(episode.moves());
                summary.ticks += 1;
                if summary.ticks.is_multiple_of(1000) {
                    flow = each(summary.ticks);
                }
                if flow.is_break() {
                    break;
                }
            }
            summary.counts += episode.monitor.counts;
            summary.ended += episode.monitor.ended;
            summary.episodes += 1;
        }
        summary.tick_us = [500, 999].map(|thousandths| times.quantile(thousandths));
        Ok(summary)
    }
}

/// As one object with the names of the book.
impl Serialize for Summary {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let counts = &self.counts;
        let line = Line {
            ticks: self.ticks,
            infeasible: counts.infeasible,
            not_finite: counts.not_finite,
            limit_violations: counts.limit_violations,
            acceleration_violations: counts.acceleration_violations,
            jerk_violations: counts.jerk_violations,
            torque_violations: counts.torque_violations,
            separation_violations: counts.separation_violations,
            discontinuities: counts.discontinuities,
            tick_us_p50: self.tick_us[0],
            tick_us_p999: self.tick_us[1],
            self_collisions: counts.self_collisions,
            person_caused: counts.person_caused,
            contact: counts.contact,
            moving: self.moving,
            episodes: self.episodes,
            wrong_states: counts.wrong_states,
            disturbances: self.ended,
        };
        line.serialize(serializer)
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let counts = &self.counts;
        for (what, count) in [
            ("ticks", self.ticks),
            ("  of them with the robot moving", self.moving),
            ("episodes", self.episodes),
            ("problems not solved", counts.infeasible),
            ("commands not finite", counts.not_finite),
            ("limits of position or velocity violated", counts.limit_violations),
            ("limits of acceleration violated", counts.acceleration_violations),
            ("limits of jerk violated", counts.jerk_violations),
            ("limits of torque violated", counts.torque_violations),
            ("protective distance violated by the robot", counts.separation_violations),
            ("jumps of the desired velocity", counts.discontinuities),
            ("self-collisions", counts.self_collisions),
            ("disturbed, and in a state that is not enough", counts.wrong_states),
            ("protective distance undercut by the person", counts.person_caused),
            ("coming nearer to arms in collaboration", counts.contact),
        ] {
            writeln!(f, "{what:46} {count:>10}")?;
        }
        let [median, worst] = self.tick_us;
        writeln!(f, "{:46} {median:>10.1}", "tick, median [µs]")?;
        write!(f, "{:46} {worst:>10.1}", "tick, 99.9th percentile [µs]")
    }
}
