//! An experiment as a list of independent cases, which several machines may share.

use std::fmt::Display;
use std::io::Write;
use std::path::Path;
use std::sync::Arc;

use anyhow::{Result, ensure};
use ergo_map::{ErgonomicsMap, MapOptions, Person};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::cases::play_all;
use super::options::{Common, Conditions, write_figure};
use super::player::Player;
use super::recorded::{Needs, Recorded};
use super::shown::Shown;
use crate::maps::build_map;
use crate::program::{Ending, Json, Session};
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
    /// SHA-256 of each recording that is played in place of random cases, hexadecimal.
    pub recordings: Vec<String>,
}

/// Independent cases, and what they come to together.
pub trait Experiment {
    /// The name of the program and of the experiment, as files of shards hold it.
    const PROGRAM: &'static str;
    /// The name of the experiment on the command line, of its figure and of its page.
    const NAME: &'static str;
    /// What recordings must hold.
    const NEEDS: Needs;
    /// What is played; everything random in it comes from the seed and its number.
    type Case: Sync;
    /// What a case came to.
    type Trial: Send + Serialize + DeserializeOwned;
    /// What all came to: a table, and the fields for `--json`.
    type Outcome: Display + Serialize;

    /// The cases of a job: of its recordings, or random ones if there are none.
    fn cases(job: &Job, recordings: &[Arc<Recorded>]) -> Vec<Self::Case>;

    /// Plays one; the map is that of the average person.
    ///
    /// # Errors
    /// Settings that the controller refuses.
    fn play(
        case: &Self::Case,
        average: &ErgonomicsMap,
        conditions: Conditions,
        player: &mut Player,
    ) -> Result<Self::Trial>;

    /// What trials came to, in the order of their cases.
    fn outcome(trials: Vec<Self::Trial>) -> Self::Outcome;

    /// The figure of an outcome, as SVG.
    ///
    /// # Errors
    /// A figure that cannot be drawn.
    fn figure(outcome: &Self::Outcome) -> Result<String>;
}

/// Plays the cases of a shard, prints the table, draws the figure and writes the page.
///
/// # Errors
/// A folder or a file that cannot be written; recordings that cannot be played; a case that cannot be played.
pub(super) fn run<E: Experiment>(
    common: &Common,
    duration: f64,
    session: &mut Session,
) -> Result<Ending> {
    common.prepare()?;
    let recordings: Vec<_> =
        Recorded::read_all(&common.recording, E::NEEDS)?.into_iter().map(Arc::new).collect();
    let job = common.job(duration, &recordings);
    let all = E::cases(&job, &recordings);
    let cases = all.len() as u64;
    ensure!(common.show < cases, "--show {}: there are {cases} cases, from 0", common.show);
    let file = common.shards.create()?;
    let shard = common.shards.shard();
    let average = build_map(session, &Person::average(), &MapOptions::default(), None)?;
    let own: Vec<(u64, E::Case)> =
        (0..).zip(all).filter(|(number, _)| shard.holds(*number)).collect();
    let wanted = common.figures().map(|_| common.show);
    let (played, ending) =
        play_all(session, E::NAME, common.threads, &own, |(number, case), interrupt| {
            let mut player = if wanted == Some(*number) {
                Player::recording(interrupt.clone())
            } else {
                Player::new(interrupt.clone())
            };
            let trial = E::play(case, &average, job.conditions, &mut player)?;
            Ok(((*number, trial), Shown::of(*number, player.into_shown())))
        })?;
    let (trials, shown): (Vec<_>, Vec<_>) = played.into_iter().unzip();
    let shown = shown.into_iter().flatten().next();
    let results = trials.into_iter().collect();
    let part = Part { program: E::PROGRAM.to_owned(), job, shard, cases, results, times: () };
    // A shard that is not whole cannot be merged.
    if ending == Ending::Complete {
        ShardOptions::write(file, &part)?;
    }
    let trials = part.results.into_values().collect();
    conclude::<E>(&part.job, trials, shown.as_ref(), common.figures(), common.json, ending, session)
}

/// Makes of the files of all shards what one machine prints and draws; the figure into a folder, if there is one.
/// There is no page: files of shards hold numbers only.
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
    conclude::<E>(&job, results, None, figures, json, Ending::Complete, session)
}

/// The line of `--json`.
#[derive(Serialize)]
struct Line<'a, T> {
    experiment: &'static str,
    seed: u64,
    #[serde(flatten)]
    outcome: &'a T,
    /// What the runs on the page came to; none without a page.
    #[serde(skip_serializing_if = "Option::is_none")]
    shown: Option<&'a Shown>,
}

fn conclude<E: Experiment>(
    job: &Job,
    trials: Vec<E::Trial>,
    shown: Option<&Shown>,
    figures: Option<&Path>,
    json: Json,
    ending: Ending,
    session: &mut Session,
) -> Result<Ending> {
    let outcome = E::outcome(trials);
    let table = outcome.to_string();
    if let Some(folder) = figures {
        let file = |kind: &str| folder.join(format!("{}.{kind}", E::NAME));
        write_figure(&file("svg"), &E::figure(&outcome)?, ending)?;
        if let Some(shown) = shown {
            write_figure(&file("html"), &shown.page(E::PROGRAM, &table)?, ending)?;
        }
    }
    write!(session.output(), "{table}")?;
    let line = Line { experiment: E::NAME, seed: job.seed, outcome: &outcome, shown };
    session.conclude(json, &line, ending)
}
