//! Plays the cases of a shard, and prints and draws the results of them or of all shards.

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Result, ensure};
use ergo_map::{MapOptions, Person};
use moca_simulation::experiment::{Experiment, Job, Player, Shown, play_all};
use serde::Serialize;

use super::options::{Common, write_figure};
use super::recordings;
use crate::maps::build_map;
use crate::program::{Ending, Printing, Session};
use crate::shards::{Merged, Part, ShardOptions};

/// Names of the program and the experiment in shard files.
pub fn program<E: Experiment>() -> String {
    format!("experiment {}", E::NAME)
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
    let read = recordings::read_all(&common.recording, E::NEEDS)?;
    let (recordings, digests): (Vec<_>, Vec<_>) = read.into_iter().unzip();
    let job = common.job(duration, digests);
    let all = E::cases(&job, &recordings);
    let cases = all.len() as u64;
    ensure!(common.show < cases, "--show {}: there are {cases} cases, from 0", common.show);
    let file = common.shards.create()?;
    let shard = common.shards.shard();
    let average = build_map(session, &Person::average(), &MapOptions::default(), None)?;
    let own: Vec<(u64, E::Case)> =
        (0..).zip(all).filter(|(number, _)| shard.contains(*number)).collect();
    let wanted = common.figures().map(|_| common.show);
    let progress = session.progress(E::NAME, own.len() as u64);
    let interrupt = session.interrupt();
    let each = |done| {
        progress.set(done);
        interrupt.flow()
    };
    let played = play_all(&own, common.threads.count(), each, |(number, case), go_on| {
        let player = Player::new(go_on);
        let mut player = if wanted == Some(*number) { player.recording() } else { player };
        let trial = E::play(case, &average, job.conditions, &mut player)?;
        Ok(((*number, trial), Shown::of(*number, player.into_shown())))
    });
    progress.finish();
    let (results, shown): (Vec<_>, Vec<_>) = played?.into_iter().unzip();
    let ending = if results.len() < own.len() { Ending::Partial } else { Ending::Complete };
    let shown = shown.into_iter().flatten().next();
    let results = results.into_iter().collect();
    let part = Part { program: program::<E>(), job, shard, cases, results, times: () };
    // An incomplete shard cannot be merged.
    if ending == Ending::Complete {
        ShardOptions::write(file, &part)?;
    }
    let trials = part.results.into_values().collect();
    conclude::<E>(
        &part.job,
        trials,
        shown.as_ref(),
        common.figures(),
        common.printing,
        ending,
        session,
    )
}

/// Prints and draws the result of the files of all shards, as on one machine. The figure goes into a folder, if there
/// is one. There is no page, since shard files only contain numbers.
///
/// # Errors
/// Those of [`Merged::read`], and a folder that cannot be written.
pub fn merge<E: Experiment>(
    files: &[PathBuf],
    figures: Option<&Path>,
    printing: Printing,
    session: &mut Session,
) -> Result<Ending> {
    let Merged { job, results, times } = Merged::read(files)?;
    let _: Vec<()> = times;
    conclude::<E>(&job, results, None, figures, printing, Ending::Complete, session)
}

/// The JSON object of `--json`.
#[derive(Serialize)]
struct Line<'a, T> {
    experiment: &'static str,
    seed: u64,
    #[serde(flatten)]
    outcome: &'a T,
    /// The results of the runs on the page; `None` without a page.
    #[serde(skip_serializing_if = "Option::is_none")]
    shown: Option<&'a Shown>,
}

fn conclude<E: Experiment>(
    job: &Job,
    trials: Vec<E::Trial>,
    shown: Option<&Shown>,
    figures: Option<&Path>,
    printing: Printing,
    ending: Ending,
    session: &mut Session,
) -> Result<Ending> {
    let outcome = E::outcome(trials);
    let table = outcome.to_string();
    if let Some(folder) = figures {
        let file = |kind: &str| folder.join(format!("{}.{kind}", E::NAME));
        write_figure(&file("svg"), &E::figure(&outcome)?, ending)?;
        if let Some(shown) = shown {
            write_figure(&file("html"), &shown.page(&program::<E>(), &table)?, ending)?;
        }
    }
    write!(session.output(), "{table}")?;
    let line = Line { experiment: E::NAME, seed: job.seed, outcome: &outcome, shown };
    session.conclude(printing, &line, ending)
}
