//! Experiment 3: the robot takes the object and turns it to the surface that the person's tool is for.

mod judge;

use std::fmt;
use std::sync::Arc;

use ergo_map::ErgonomicsMap;
use moca_model::Goal;
use nalgebra::Point2;
use rand::Rng;
use serde::{Deserialize, Serialize};
use simulated_people::{WalkerSettings, WalkingPath};
use vision_models::Surface;

use super::cases::generator;
use super::chart::{Panel, Series, Style, chart};
use super::conditions::Conditions;
use super::job::{Experiment, Job};
use super::player::Player;
use super::recorded::{Needs, Recorded};
use super::source::Source;
use super::spread::Spread;
use super::versus::Versus;
use super::walk::ARM_SPEED;
use crate::error::Error;
use crate::run::Summary;
pub use judge::{Judge, Turn};

/// Duration of each case \[s\].
pub const DURATION: f64 = 30.0;

/// Time for which the person holds the object out, until the robot has come for it \[s\].
const OFFER: f64 = 10.0;

/// Experiment 3: random people hand the object over and take the tool for the surface that they do not see.
///
/// The robot identifies the surfaces by its camera, and turns the object once the person engages. The results are with
/// and without ergonomics:
///
/// - how many turns end with the right surface in front of the person;
/// - their time over the least time that the limits of the desired pose allow;
/// - the ergonomics of the person;
/// - every transition of the first case.
#[derive(Clone, Copy, Debug)]
pub struct Reorientation;

/// A person who hands the object over and takes the tool for its far side.
#[derive(Clone, Debug)]
pub struct Case {
    /// Number of the case, from 0.
    pub number: u64,
    /// The person and their tool.
    pub person: Source,
    /// The surface in front once the robot has the object.
    pub front: Surface,
}

/// The cases of a seed.
pub fn cases(seed: u64, count: u64) -> Vec<Case> {
    (0..count)
        .map(|number| {
            let mut draw = generator(seed, number);
            let front = if draw.random_bool(0.5) { Surface::Drilled } else { Surface::Smooth };
            let walker = WalkerSettings {
                stature: draw.random_range(1.58..=1.94),
                path: WalkingPath::Points(vec![Point2::new(1.4, 0.0)]),
                tool: other(front).tool(),
                offer: OFFER,
                duration: DURATION,
                seed: draw.random(),
                arm_speed: Some(ARM_SPEED),
                ..WalkerSettings::default()
            };
            Case { number, person: Source::Simulated(walker), front }
        })
        .collect()
}

fn other(surface: Surface) -> Surface {
    match surface {
        Surface::Drilled => Surface::Smooth,
        Surface::Smooth => Surface::Drilled,
    }
}

/// The result of a case, with and without ergonomics.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Trial {
    summaries: [Summary; 2],
    turns: [Turn; 2],
    /// Transitions of the run with ergonomics, a line each.
    transitions: Vec<String>,
    number: u64,
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
    ) -> Result<Trial, Error> {
        let mut draw = generator(self.person.seed(), self.number);
        let map = average.for_stature(self.person.stature())?;
        let walk = self.person.walk(conditions.sight)?;
        // The robot is wrong in half of the cases until it has looked.
        let scenario = walk.scenario(&map, conditions, &mut draw)?.handed_over(self.front);
        let needed = self.person.tool().surface();
        let mut play = |title, goal| {
            let mut judge = Judge::new(&scenario, &walk.truth, needed);
            let mut transitions = Vec::new();
            let summary = player.play(title, &scenario, goal, |row, plant| {
                if let Some(transition) = plant.command().transition {
                    transitions.push(format!(
                        "{:>7.3} s  {:?} -> {:?}: {:?}",
                        transition.time, transition.from, transition.to, transition.reason
                    ));
                }
                judge.push(row.time, plant);
            })?;
            Ok::<_, Error>((summary, judge.turn(), transitions))
        };
        let (on, turn_on, transitions) = play("Ergonomics on", Goal::Ergonomics)?;
        let (off, turn_off, _) = play("Ergonomics off", Goal::LeastMotion)?;
        let number = self.number;
        Ok(Trial { summaries: [on, off], turns: [turn_on, turn_off], transitions, number })
    }
}

/// The turns with or without ergonomics.
#[derive(Clone, Debug, Serialize)]
pub struct TurnsLine {
    /// Number of cases.
    pub cases: usize,
    /// Cases in which the object was handed over.
    pub grasped: usize,
    /// Cases in which the person engages with the wrong surface in front of them, and the robot notices.
    pub recognised: usize,
    /// Cases that end with the right surface in front of the person.
    pub right: usize,
    /// Those of them within the joints' limits and without a separation violation or a protective stop.
    pub safe: usize,
    /// Time from the recognised mismatch to the work pose \[s\].
    pub time_s: Spread,
    /// Part of that time in which the robot is slowed, stands or retreats because of the person \[s\].
    pub hindered_s: Spread,
    /// The time over the least time that the limits of the desired pose allow.
    pub ratio: Spread,
}

/// The result of the experiment.
#[derive(Debug, Serialize)]
pub struct ReorientationResult {
    /// Turns with ergonomics.
    pub turns_on: TurnsLine,
    /// Turns without ergonomics.
    pub turns_off: TurnsLine,
    #[serde(flatten)]
    versus: Versus,
    #[serde(skip)]
    ratios: Vec<(f64, f64)>,
    #[serde(skip)]
    first: Vec<String>,
    /// Cases that end with the wrong surface with ergonomics, and what happened in them.
    #[serde(skip)]
    wrong: Vec<String>,
}

impl ReorientationResult {
    /// Creates the result of these trials.
    pub fn new(trials: Vec<Trial>) -> Self {
        let line = |run: usize| {
            let count =
                |of: fn(&Turn) -> bool| trials.iter().filter(|trial| of(&trial.turns[run])).count();
            let clean = |summary: &Summary| {
                summary.limit_violations == 0
                    && summary.separation_violations == 0
                    && summary.protective_stops == 0
            };
            let turns = || trials.iter().map(|trial| &trial.turns[run]);
            TurnsLine {
                cases: trials.len(),
                grasped: count(|turn| turn.grasped),
                recognised: count(|turn| turn.recognised),
                right: count(|turn| turn.right),
                safe: trials
                    .iter()
                    .filter(|trial| trial.turns[run].right && clean(&trial.summaries[run]))
                    .count(),
                time_s: Spread::of(turns().filter_map(|turn| turn.time)),
                hindered_s: Spread::of(
                    turns().filter(|turn| turn.time.is_some()).map(|turn| turn.hindered),
                ),
                ratio: Spread::of(turns().filter_map(Turn::ratio)),
            }
        };
        let ratios = trials
            .iter()
            .filter_map(|trial| Some((trial.turns[0].least_time?, trial.turns[0].time?)));
        let wrong = trials.iter().filter(|trial| !trial.turns[0].right).map(|trial| {
            let [x, y, z] = trial.turns[0].off;
            let lines = trial.transitions.join("\n");
            format!("case {} ends turned by ({x:.2}, {y:.2}, {z:.2}) rad\n{lines}", trial.number)
        });
        Self {
            wrong: wrong.collect(),
            turns_on: line(0),
            turns_off: line(1),
            ratios: ratios.collect(),
            first: trials.first().map(|trial| trial.transitions.clone()).unwrap_or_default(),
            versus: Versus::new(trials.into_iter().map(|trial| trial.summaries)),
        }
    }

    fn figure(&self) -> Result<String, Error> {
        let dots = |name, points| Series { name, style: Style::Dots, points };
        chart(&[
            Panel {
                title: "Each dot a turn",
                x: "time that the limits allow (s)",
                y: "time (s)",
                series: vec![dots("with ergonomics", self.ratios.clone())],
                diagonal: true,
            },
            Panel {
                title: "Each dot a person",
                x: "mean e_s without ergonomics",
                y: "mean e_s with ergonomics",
                series: vec![dots(
                    "case",
                    self.versus.scores().map(|(on, off)| (off, on)).collect(),
                )],
                diagonal: true,
            },
        ])
    }
}

impl fmt::Display for ReorientationResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "the first case, with ergonomics")?;
        for line in &self.first {
            writeln!(f, "{line}")?;
        }
        for case in &self.wrong {
            writeln!(f, "{case}")?;
        }
        writeln!(f, "\n{:<58}{:>10}{:>10}", "ergonomics", "on", "off")?;
        let (on, off) = (&self.turns_on, &self.turns_off);
        for (name, of) in [
            ("cases", (|line| line.cases) as fn(&TurnsLine) -> usize),
            ("object handed over", |line| line.grasped),
            ("wrong surface recognised", |line| line.recognised),
            ("right surface before the person at the end", |line| line.right),
            ("  and no limit, distance or protective stop violated", |line| line.safe),
        ] {
            writeln!(f, "{name:<58}{:>10}{:>10}", of(on), of(off))?;
        }
        for (name, of) in [
            ("time of a turn, mean [s]", (|line| line.time_s.mean) as fn(&TurnsLine) -> f64),
            ("time of a turn, worst [s]", |line| line.time_s.worst),
            ("  of it hindered by the person's nearness, mean [s]", |line| line.hindered_s.mean),
            ("  of it hindered by the person's nearness, worst [s]", |line| line.hindered_s.worst),
            ("over the time that the limits allow, mean", |line| line.ratio.mean),
            ("over the time that the limits allow, worst", |line| line.ratio.worst),
        ] {
            writeln!(f, "{name:<58}{:>10.2}{:>10.2}", of(on), of(off))?;
        }
        writeln!(f, "\n{}", self.versus)
    }
}

impl Experiment for Reorientation {
    const NAME: &'static str = "reorientation";
    const NEEDS: Needs = Needs::Surfaces;
    type Case = Case;
    type Trial = Trial;
    type Outcome = ReorientationResult;

    fn cases(job: &Job, recordings: &[Arc<Recorded>]) -> Vec<Case> {
        if recordings.is_empty() {
            return cases(job.seed, job.cases);
        }
        let people = Source::of_recordings(recordings, job.seed).into_iter();
        let fronts = recordings.iter().filter_map(|recording| recording.facing_camera).map(other);
        people.zip(fronts).map(|((number, person), front)| Case { number, person, front }).collect()
    }

    fn play(
        case: &Case,
        average: &ErgonomicsMap,
        conditions: Conditions,
        player: &mut Player<'_>,
    ) -> Result<Trial, Error> {
        case.play(average, conditions, player)
    }

    fn outcome(trials: Vec<Trial>) -> ReorientationResult {
        ReorientationResult::new(trials)
    }

    fn figure(outcome: &ReorientationResult) -> Result<String, Error> {
        outcome.figure()
    }
}
