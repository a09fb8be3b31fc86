//! Experiment 4: the person walks while they work, and the robot follows.

mod speeds;

use std::fmt;
use std::io::Write;

use anyhow::Result;
use clap::Args;
use ergo_map::{ErgonomicsMap, MapOptions, Person};
use moca_model::Goal;
use rand::Rng;
use rand::seq::IndexedRandom;
use serde::Serialize;
use vision_models::Tool;

use super::cases::{generator, play_all};
use super::chart::{Panel, Series, Style, chart};
use super::options::{Common, Conditions};
use super::versus::{Versus, VersusLine};
use super::walk::Walk;
use crate::ergonomics::build_map;
use crate::follow::{Run, Summary};
use crate::program::{Ending, Interrupt, Quiet, Session};
use crate::simulation::{WalkerSettings, WalkingPath};
pub use speeds::{SpeedResult, Speeds};

/// Experiment 4: random people lead the robot along random paths.
///
/// Prints the person's ergonomics with ergonomics on the third level of the stack and with the
/// paper's benchmark there, then how far the robot falls behind people who walk straight at up to
/// its own speed.
#[derive(Args, Debug)]
pub struct Following {
    #[command(flatten)]
    common: Common,
    /// Of each case (s).
    #[arg(long, value_name = "SECONDS", default_value_t = 35.0, value_parser = seconds)]
    duration: f64,
}

fn seconds(text: &str) -> Result<f64, &'static str> {
    let value = text.parse().ok();
    value.filter(|value| (20.0..=600.0).contains(value)).ok_or("give 20 to 600 seconds")
}

/// A person who leads the robot along a path.
#[derive(Clone, Debug)]
pub struct Case {
    /// Of everything random, with the number of the case.
    pub seed: u64,
    /// Its number, from 0.
    pub number: u64,
    /// Who walks where.
    pub walker: WalkerSettings,
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
                ..WalkerSettings::default()
            };
            Case { seed, number, walker }
        })
        .collect()
}

impl Case {
    /// Plays it with ergonomics and without.
    ///
    /// # Errors
    /// Settings that the controller refuses.
    pub fn play(
        &self,
        average: &ErgonomicsMap,
        conditions: Conditions,
        interrupt: &Interrupt,
    ) -> Result<[Summary; 2]> {
        // Apart from the walk's, from which the same generator drew before.
        let mut draw = generator(self.walker.seed, self.number);
        let map = average.for_stature(self.walker.stature)?;
        let scenario = Walk::new(self.walker.clone(), conditions.sight)?.scenario(
            &map,
            conditions.drive,
            &mut draw,
        )?;
        let play = |goal| Run::new(&scenario, goal)?.until(interrupt.clone()).play(|_| Ok(()));
        Ok([play(Goal::Ergonomics)?, play(Goal::LeastMotion)?])
    }
}

/// What the experiment came to.
#[derive(Debug)]
pub struct FollowingResult {
    /// On random paths.
    pub paths: Versus,
    /// Straight on.
    pub speeds: Speeds,
}

/// The line of `--json`.
#[derive(Serialize)]
struct Line<'a> {
    experiment: &'static str,
    seed: u64,
    #[serde(flatten)]
    paths: VersusLine,
    speeds: &'a [SpeedResult],
}

impl fmt::Display for FollowingResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}\n\n{}", self.paths, self.speeds)
    }
}

impl Following {
    /// `--quiet`.
    pub fn quiet(&self) -> Quiet {
        self.common.quiet
    }

    /// Plays the cases, prints the table and draws the figures.
    ///
    /// # Errors
    /// A folder that cannot be written; a case that cannot be played.
    pub fn run(self, session: &mut Session) -> Result<Ending> {
        let common = &self.common;
        common.prepare()?;
        let average = build_map(session, &Person::average(), &MapOptions::default(), None)?;
        let seed = common.seed.seed;
        let cases = cases(seed, common.cases, self.duration);
        let (pairs, ending) =
            play_all(session, "following", common.threads, &cases, |case, stop| {
                case.play(&average, common.conditions(), stop)
            })?;
        let (speeds, ending) = match ending {
            Ending::Complete => speeds::measure(session, common, &average)?,
            ending => (Speeds::default(), ending),
        };
        let result = FollowingResult { paths: Versus::new(pairs), speeds };
        common.write(&[("following.svg", result.figure()?)], ending)?;
        write!(session.output(), "{result}")?;
        let line = Line {
            experiment: "following",
            seed,
            paths: result.paths.line(),
            speeds: &result.speeds.rows,
        };
        session.conclude(common.json, &line, ending)
    }
}

impl FollowingResult {
    fn figure(&self) -> Result<String> {
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
