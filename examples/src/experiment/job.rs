//! An experiment as a list of independent cases, which several machines may share.

use std::fmt::Display;
use std::io::Write;
use std::path::Path;

use anyhow::Result;
use ergo_map::{ErgonomicsMap, MapOptions, Person};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::cases::play_all;
use super::options::{Common, Conditions, write_figure};
use crate::ergonomics::build_map;
use crate::program::{Ending, Interrupt, Json, Session};
use crate::shards::{Merged, Part, ShardOptions};

/// What is to be played: all that the results depend on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Job {
    /// Of everything random.
    pub seed: u64,
    /// How many random cases are asked for.
    pub cases: u64,
    /// Of a random case \[s\].
    pub duration: f64,
    /// What is the same in all cases.
    pub conditions: Conditions,
}

/// Independent cases, and what they come to together.
pub trait Experiment {
    /// The name of the program and of the experiment, as files of shards hold it.
    const PROGRAM: &'static str;
    /// The name of the experiment on the command line, and of its figure.
    const NAME: &'static str;
    /// What is played; everything random in it comes from the seed and its number.
    type Case: Sync;
    /// What a case came to.
    type Trial: Send + Serialize + DeserializeOwned;
    /// What all came to: a table, and the fields for `--json`.
    type Outcome: Display + Serialize;

    /// The cases of a job.
    fn cases(job: &Job) -> Vec<Self::Case>;

    /// Plays one; the map is that of the average person.
    ///
    /// # Errors
    /// Settings that the controller refuses.
    fn play(
        case: &Self::Case,
        average: &ErgonomicsMap,
        conditions: Conditions,
        interrupt: &Interrupt,
    ) -> Result<Self::Trial>;

    /// What trials came to, in the order of their cases.
    fn outcome(trials: Vec<Self::Trial>) -> Self::Outcome;

    /// The figure of an outcome, as SVG.
    ///
    /// # Errors
    /// A figure that cannot be drawn.
    fn figure(outcome: &Self::Outcome) -> Result<String>;
}

/// Plays the cases of a shard, prints the table and draws the figure.
///
/// # Errors
/// A folder or a file that cannot be written; a case that cannot be played.
pub(super) fn run<E: Experiment>(
    common: &Common,
    duration: f64,
    session: &mut Session,
) -> Result<Ending> {
    common.prepare()?;
    let file = common.shards.create()?;
    let job = common.job(duration);
    let shard = common.shards.shard();
    let average = build_map(session, &Person::average(), &MapOptions::default(), None)?;
    let all = E::cases(&job);
    let cases = all.len() as u64;
    let own: Vec<(u64, E::Case)> =
        (0..).zip(all).filter(|(number, _)| shard.holds(*number)).collect();
    let (trials, ending) =
        play_all(session, E::NAME, common.threads, &own, |(number, case), interrupt| {
            Ok((*number, E::play(case, &average, job.conditions, interrupt)?))
        })?;
    let results = trials.into_iter().collect();
    let part = Part { program: E::PROGRAM.to_owned(), job, shard, cases, results, times: () };
    // A shard that is not whole cannot be merged.
    if ending == Ending::Complete {
        ShardOptions::write(file, &part)?;
    }
    let trials = part.results.into_values().collect();
    conclude::<E>(&part.job, trials, common.figures(), common.json, ending, session)
}

/// Makes of the files of all shards what one machine prints and draws; the figure into a folder, if there is one.
///
/// # Errors
/// Those of [`Merged::read`], and a folder that cannot be written.
pub fn merge<E: Experiment>(
    files: &[std::path::PathBuf],
    figures: Option<&Path>,
    json: Json,
    session: &mut Session,
) -> Result<Ending> {
    let Merged { job, results, times } = Merged::read(files)?;
    let _: Vec<()> = times;
    conclude::<E>(&job, results, figures, json, Ending::Complete, session)
}

/// The line of `--json`.
#[derive(Serialize)]
struct Line<'a, T> {
    experiment: &'static str,
    seed: u64,
    #[serde(flatten)]
    outcome: &'a T,
}

fn conclude<E: Experiment>(
    job: &Job,
    trials: Vec<E::Trial>,
    figures: Option<&Path>,
    json: Json,
    ending: Ending,
    session: &mut Session,
) -> Result<Ending> {
    let outcome = E::outcome(trials);
    if let Some(folder) = figures {
        let name = format!("{}.svg", E::NAME);
        write_figure(&folder.join(name), &E::figure(&outcome)?, ending)?;
    }
    write!(session.output(), "{outcome}")?;
    let line = Line { experiment: E::NAME, seed: job.seed, outcome: &outcome };
    session.conclude(json, &line, ending)
}
