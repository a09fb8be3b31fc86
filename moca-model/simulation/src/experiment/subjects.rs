//! Experiment 5: ten people from 1.58 to 1.94 m, each with their own map, the average one and none.

use std::fmt;
use std::sync::Arc;

use ergo_map::{ErgonomicsMap, Person};
use moca_model::{Goal, SpaceSettings};
use rand::Rng;
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
use super::spread::{Duel, Spread};
use super::walk::{ARM_SPEED, FIT};
use crate::error::Error;
use crate::run::Summary;

/// Number of people.
const SUBJECTS: u64 = 10;
/// Range of statures in the paper, in which the people are evenly spaced \[m\].
const STATURES: [f64; 2] = [1.58, 1.94];
/// Stature of the average map: the middle of the range \[m\].
const AVERAGE: f64 = 0.5 * (STATURES[0] + STATURES[1]);

/// Experiment 5: people of ten statures lead the robot. It knows their own ergonomics map, chooses one by the measured
/// stature, only knows the average map, or knows none.
///
/// Only the map differs: the shared workspace is that of the average person in all runs. The person's own map scores
/// the postures.
#[derive(Clone, Copy, Debug)]
pub struct Subjects;

/// The robot's knowledge of the person's ergonomics.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Knowledge {
    /// The person's own map.
    Own,
    /// The average map, adapted to the measured stature.
    Measured,
    /// The average map.
    Average,
    /// Nothing. The benchmark min ‖ẋ_d‖² is used.
    Nothing,
}

impl Knowledge {
    /// Kinds of knowledge in the order of the table.
    pub const ALL: [Self; 4] = [Self::Own, Self::Measured, Self::Average, Self::Nothing];

    fn name(self) -> &'static str {
        match self {
            Self::Own => "own map",
            Self::Measured => "measured",
            Self::Average => "average map",
            Self::Nothing => "no map",
        }
    }
}

/// A person who leads the robot from station to station, or in random directions.
#[derive(Clone, Debug)]
pub struct Case {
    /// Number of the person, from 0 to 9, or of the recording.
    pub subject: u64,
    /// The person and their path.
    pub person: Source,
}

/// The cases of a seed. Each person has the same number of cases, at least one.
pub fn cases(seed: u64, count: u64, duration: f64) -> Vec<Case> {
    let each = count.div_ceil(SUBJECTS);
    (0..SUBJECTS * each)
        .map(|number| {
            let mut draw = generator(seed, number);
            let subject = number / each;
            let walker = WalkerSettings {
                stature: stature(subject),
                path: if draw.random_bool(0.5) {
                    WalkingPath::Stations
                } else {
                    WalkingPath::Directions
                },
                tool: if draw.random_bool(0.5) { Tool::Drill } else { Tool::Polisher },
                duration,
                seed: draw.random(),
                arm_speed: Some(ARM_SPEED),
                ..WalkerSettings::default()
            };
            Case { subject, person: Source::Simulated(walker) }
        })
        .collect()
}

fn stature(subject: u64) -> f64 {
    let [least, greatest] = STATURES;
    least + (greatest - least) * subject as f64 / (SUBJECTS - 1) as f64
}

impl Case {
    fn play(
        &self,
        average: &ErgonomicsMap,
        conditions: Conditions,
        player: &mut Player<'_>,
    ) -> Result<[Summary; 4], Error> {
        let own = average.for_stature(self.person.stature())?;
        let mut draw = generator(self.person.seed(), self.subject);
        let walk = self.person.walk(conditions.sight)?;
        let mut scenario = walk.scenario(&own, conditions, &mut draw)?;
        let everybody = average.for_stature(AVERAGE)?;
        let space = scenario.settings.space;
        scenario.settings.space =
            SpaceSettings::for_person(space, &Person::new(AVERAGE)?, everybody.side());
        let known = scenario.ergonomics;
        let (usual, _) = everybody.fit(&FIT)?;
        let mut play = |knowledge: Knowledge| {
            let (ergonomics, adapts_from) = match knowledge {
                Knowledge::Own | Knowledge::Nothing => (known, None),
                Knowledge::Measured => (usual, Some(AVERAGE)),
                Knowledge::Average => (usual, None),
            };
            (scenario.ergonomics, scenario.adapts_from) = (ergonomics, adapts_from);
            // The page shows the best and the least knowledge, like those of the other experiments.
            match knowledge {
                Knowledge::Own => player.play("Own map", &scenario, Goal::Ergonomics, |_, _| {}),
                Knowledge::Nothing => {
                    player.play("No map", &scenario, Goal::LeastMotion, |_, _| {})
                }
                _ => player.play_unseen(&scenario, Goal::Ergonomics, |_, _| {}),
            }
        };
        let [own, measured, average, nothing] = Knowledge::ALL;
        Ok([play(own)?, play(measured)?, play(average)?, play(nothing)?])
    }
}

/// The result of a case.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SubjectTrial {
    /// Stature of the person \[m\].
    stature: f64,
    /// The run with each kind of knowledge, in the order of [`Knowledge::ALL`].
    runs: [Summary; 4],
}

/// The results of one person in all their cases.
#[derive(Clone, Debug, Serialize)]
pub struct Subject {
    /// Stature \[m\].
    pub stature: f64,
    cases: usize,
    /// Mean e_s with the own map.
    pub own: Spread,
    /// Mean e_s with the map of the measured stature.
    pub measured: Spread,
    /// Mean e_s with the average map.
    pub average: Spread,
    /// Mean e_s without a map.
    pub nothing: Spread,
    /// Reduction of the mean e_s by the own map relative to the average one \[%\].
    pub better_than_average_percent: f64,
}

/// The result of the experiment.
#[derive(Clone, Debug, Serialize)]
pub struct SubjectsResult {
    /// Results of each person.
    pub subjects: Vec<Subject>,
    /// The own map against the average one, case by case.
    pub own_against_average: Duel,
    /// The map of the measured stature against the average one.
    pub measured_against_average: Duel,
    /// The own map against the benchmark.
    pub own_against_none: Duel,
    /// Cases in which person and robot never worked together, which no other number includes.
    pub apart: usize,
    limit_violations: u64,
    torque_violations: u64,
    separation_violations: u64,
    protective_stops: u64,
}

impl SubjectsResult {
    fn new(trials: &[SubjectTrial]) -> Self {
        let met = |trial: &&SubjectTrial| trial.runs.iter().all(|run| run.together > 0.0);
        let together: Vec<_> = trials.iter().filter(met).collect();
        let duel = |first: usize, second: usize| {
            Duel::of(
                together
                    .iter()
                    .map(|trial| (trial.runs[first].score_mean, trial.runs[second].score_mean)),
            )
        };
        let sum =
            |of: fn(&Summary) -> u64| trials.iter().flat_map(|trial| &trial.runs).map(of).sum();
        let mut statures: Vec<f64> = together.iter().map(|trial| trial.stature).collect();
        statures.sort_by(f64::total_cmp);
        statures.dedup();
        let subjects = statures.into_iter().map(|stature| {
            let own: Vec<_> = together.iter().filter(|trial| trial.stature == stature).collect();
            let spread = |knowledge: usize| {
                Spread::of(own.iter().map(|trial| trial.runs[knowledge].score_mean))
            };
            let (best, usual) = (spread(0), spread(2));
            Subject {
                stature,
                cases: own.len(),
                own: best,
                measured: spread(1),
                average: usual,
                nothing: spread(3),
                better_than_average_percent: 100.0 * (1.0 - best.mean / usual.mean),
            }
        });
        Self {
            subjects: subjects.collect(),
            own_against_average: duel(0, 2),
            measured_against_average: duel(1, 2),
            own_against_none: duel(0, 3),
            apart: trials.len() - together.len(),
            limit_violations: sum(|run| run.limit_violations),
            torque_violations: sum(|run| run.torque_violations.unwrap_or_default()),
            separation_violations: sum(|run| run.separation_violations),
            protective_stops: sum(|run| run.protective_stops),
        }
    }

    fn figure(&self) -> Result<String, Error> {
        let of = |name, spread: fn(&Subject) -> Spread| Series {
            name,
            style: Style::Line,
            points: self.subjects.iter().map(|one| (one.stature, spread(one).mean)).collect(),
        };
        let series = vec![
            of(Knowledge::Own.name(), |one| one.own),
            of(Knowledge::Average.name(), |one| one.average),
            of(Knowledge::Measured.name(), |one| one.measured),
            of(Knowledge::Nothing.name(), |one| one.nothing),
        ];
        let maps = series.iter().take(3).cloned().collect();
        let panel = |title, series| Panel {
            title,
            x: "stature (m)",
            y: "mean e_s",
            series,
            diagonal: false,
        };
        chart(&[panel("Who knows what of the person", series), panel("The maps alone", maps)])
    }
}

impl fmt::Display for SubjectsResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "mean e_s (0 good, 4.25 bad): mean ± spread over the cases of a person")?;
        write!(f, "{:<14}{:>6}", "stature [m]", "cases")?;
        for knowledge in Knowledge::ALL {
            write!(f, "{:>18}", knowledge.name())?;
        }
        writeln!(f, "{:>22}", "own below average [%]")?;
        for one in &self.subjects {
            write!(f, "{:<14.2}{:>6}", one.stature, one.cases)?;
            for Spread { mean, deviation, .. } in [one.own, one.measured, one.average, one.nothing]
            {
                write!(f, "{:>18}", format!("{mean:.3} ± {deviation:.3}"))?;
            }
            writeln!(f, "{:>22.1}", one.better_than_average_percent)?;
        }
        for (name, duel) in [
            ("own map against average", self.own_against_average),
            ("measured against average", self.measured_against_average),
            ("own map against no map", self.own_against_none),
        ] {
            let Duel { ratio_mean, ratio_least, wins } = duel;
            writeln!(
                f,
                "{name}: e_s {ratio_mean:.2} times less, least {ratio_least:.2}; less in {:.1} % of the cases",
                100.0 * wins
            )?;
        }
        writeln!(
            f,
            "ticks with a violated limit {}, torque limit {}, too near {}; protective stops {}; never met {}",
            self.limit_violations,
            self.torque_violations,
            self.separation_violations,
            self.protective_stops,
            self.apart
        )
    }
}

impl Experiment for Subjects {
    const NAME: &'static str = "subjects";
    const NEEDS: Needs = Needs::Tools;
    type Case = Case;
    type Trial = SubjectTrial;
    type Outcome = SubjectsResult;

    fn cases(job: &Job, recordings: &[Arc<Recorded>]) -> Vec<Case> {
        if recordings.is_empty() {
            return cases(job.seed, job.cases, job.duration);
        }
        let people = Source::of_recordings(recordings, job.seed).into_iter();
        people.map(|(subject, person)| Case { subject, person }).collect()
    }

    fn play(
        case: &Case,
        average: &ErgonomicsMap,
        conditions: Conditions,
        player: &mut Player<'_>,
    ) -> Result<SubjectTrial, Error> {
        let runs = case.play(average, conditions, player)?;
        Ok(SubjectTrial { stature: case.person.stature(), runs })
    }

    fn outcome(trials: Vec<SubjectTrial>) -> SubjectsResult {
        SubjectsResult::new(&trials)
    }

    fn figure(outcome: &SubjectsResult) -> Result<String, Error> {
        outcome.figure()
    }
}
