//! Experiment 4: the person walks while working, and the robot follows.

mod speeds;

use std::fmt;
use std::sync::Arc;

use ergo_map::ErgonomicsMap;
use moca_model::Goal;
use rand::Rng;
use rand::seq::IndexedRandom;
use serde::{Deserialize, Serialize};
use simulated_people::{WalkerSettings, WalkingPath};
use vision_models::Tool;

use super::cases::generator;
use super::chart::{Panel, Series, Style, chart};
use super::conditions::Conditions;
use super::job::{Experiment, Job};
use super::player::Player;
use super::recorded::{Needs, Recorded};
use super::source::Source;
use super::versus::Versus;
use super::walk::ARM_SPEED;
use crate::error::Error;
use crate::run::Summary;
pub use speeds::{SpeedResult, Speeds, Stroll, StrollTrial};

/// Experiment 4: random people lead the robot along random paths.
///
/// The results are the ergonomics of the person with ergonomics on the third level of the stack and with the paper's
/// benchmark there. A second part measures how far the robot falls behind people who walk straight at up to its own
/// speed.
#[derive(Clone, Copy, Debug)]
pub struct Following;

/// A person who leads the robot along a path.
#[derive(Clone, Debug)]
pub struct Case {
    /// Number of the case, from 0.
    pub number: u64,
    /// The person and their path.
    pub person: Source,
}

/// The cases of a seed.
pub fn cases(seed: u64, count: u64, duration: f64) -> Vec<Case> {
    (0..count)
        .map(|number| {
            let mut draw = generator(seed, number);
            let paths = [
                WalkingPath::Stations,
                WalkingPath::Straight,
                WalkingPath::Square,
                WalkingPath::Circle,
                WalkingPath::FigureEight,
                WalkingPath::Random,
                WalkingPath::Directions,
            ];
            let walker = WalkerSettings {
                stature: draw.random_range(1.58..=1.94),
                path: paths.choose(&mut draw).cloned().unwrap_or(WalkingPath::Random),
                tool: if draw.random_bool(0.5) { Tool::Drill } else { Tool::Polisher },
                speed: Some(draw.random_range(0.2..0.6)),
                duration,
                seed: draw.random(),
                arm_speed: Some(ARM_SPEED),
                ..WalkerSettings::default()
            };
            Case { number, person: Source::Simulated(walker) }
        })
        .collect()
}

impl Case {
    /// Plays the case with and without ergonomics.
    ///
    /// # Errors
    /// Settings that the controller refuses.
    pub fn play(
        &self,
        average: &ErgonomicsMap,
        conditions: Conditions,
        player: &mut Player<'_>,
    ) -> Result<[Summary; 2], Error> {
        // The walk has already drawn from the same generator.
        let mut draw = generator(self.person.seed(), self.number);
        let map = average.for_stature(self.person.stature())?;
        let walk = self.person.walk(conditions.sight)?;
        let scenario = walk.scenario(&map, conditions, &mut draw)?;
        let mut play = |title, goal| player.play(title, &scenario, goal, |_, _| {});
        Ok([play("Ergonomics on", Goal::Ergonomics)?, play("Ergonomics off", Goal::LeastMotion)?])
    }
}

/// The result of the experiment.
#[derive(Debug, Serialize)]
pub struct FollowingResult {
    /// Result on random paths.
    #[serde(flatten)]
    pub paths: Versus,
    /// Result on straight paths.
    pub speeds: Speeds,
}

impl fmt::Display for FollowingResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.paths)?;
        if self.speeds.rows.is_empty() { Ok(()) } else { writeln!(f, "\n{}", self.speeds) }
    }
}

/// A person who leads the robot along a random path, or walks straight.
#[derive(Clone, Debug)]
pub enum Walking {
    /// Along a random path.
    Path(Case),
    /// Straight.
    Straight(Stroll),
}

/// The result of a walk.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub enum WalkingTrial {
    /// Results with and without ergonomics.
    Path(Box<[Summary; 2]>),
    /// At one speed.
    Straight(Box<StrollTrial>),
}

impl Experiment for Following {
    const NAME: &'static str = "following";
    const NEEDS: Needs = Needs::Tools;
    type Case = Walking;
    type Trial = WalkingTrial;
    type Outcome = FollowingResult;

    fn cases(job: &Job, recordings: &[Arc<Recorded>]) -> Vec<Walking> {
        if !recordings.is_empty() {
            let people = Source::of_recordings(recordings, job.seed).into_iter();
            return people.map(|(number, person)| Walking::Path(Case { number, person })).collect();
        }
        let paths = cases(job.seed, job.cases, job.duration).into_iter().map(Walking::Path);
        paths.chain(speeds::cases(job).map(Walking::Straight)).collect()
    }

    fn play(
        case: &Walking,
        average: &ErgonomicsMap,
        conditions: Conditions,
        player: &mut Player<'_>,
    ) -> Result<WalkingTrial, Error> {
        Ok(match case {
            Walking::Path(case) => {
                WalkingTrial::Path(Box::new(case.play(average, conditions, player)?))
            }
            Walking::Straight(case) => {
                WalkingTrial::Straight(Box::new(case.play(average, conditions, player)?))
            }
        })
    }

    fn outcome(trials: Vec<WalkingTrial>) -> FollowingResult {
        let (mut paths, mut straight) = (Vec::new(), Vec::new());
        for trial in trials {
            match trial {
                WalkingTrial::Path(trial) => paths.push(*trial),
                WalkingTrial::Straight(trial) => straight.push(*trial),
            }
        }
        FollowingResult { paths: Versus::new(paths), speeds: Speeds::new(&straight) }
    }

    fn figure(outcome: &FollowingResult) -> Result<String, Error> {
        outcome.figure()
    }
}

impl FollowingResult {
    fn figure(&self) -> Result<String, Error> {
        let scores = self.paths.scores().map(|(on, off)| (off, on)).collect();
        let errors = |name, separation| Series {
            name,
            style: Style::Line,
            points: self
                .speeds
                .rows
                .iter()
                .filter(|row| row.separation == separation)
                .map(|row| (row.speed, row.steady_m.worst))
                .collect(),
        };
        chart(&[
            Panel {
                title: "Each dot a person on a path",
                x: "mean e_s without ergonomics",
                y: "mean e_s with ergonomics",
                series: vec![Series { name: "case", style: Style::Dots, points: scores }],
                diagonal: true,
            },
            Panel {
                title: "Distance error beside a walking person",
                x: "speed of the person (m/s)",
                y: "steady error, worst (m)",
                series: vec![errors("separation on", true), errors("separation off", false)],
                diagonal: false,
            },
        ])
    }
}
