//! Data sets of frames whose truth is known: a folder a class.

use std::{
    collections::BTreeMap,
    fs,
    io::Write,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, ensure};
use clap::Args;
use serde::Serialize;

use human_perception::frames::truth::TrueFilm;

use crate::program::{Ending, Json, Quiet, Session, check_folder};

/// From which frames, and where to.
#[derive(Args, Clone, Debug)]
pub struct CutOptions {
    /// Folders of frames with their truth, as `record --frames` writes them.
    #[arg(required = true)]
    frames: Vec<PathBuf>,
    /// The folder for the data set, which gets a folder for each class. Its files are links to those of the frames,
    /// or copies where the system has no links.
    #[arg(long, short, value_name = "FOLDER")]
    output: PathBuf,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    quiet: Quiet,
}

/// A sample of a data set.
#[derive(Clone, Debug)]
pub struct Sample {
    /// Its class.
    pub class: String,
    /// Where its files are, and where they go in the class's folder.
    pub files: Vec<(PathBuf, PathBuf)>,
}

/// The line of `--json`.
#[derive(Serialize)]
struct CutOut {
    output: PathBuf,
    samples: u64,
    /// Samples of each class.
    classes: BTreeMap<String, u64>,
}

impl CutOptions {
    /// The option `--quiet`.
    pub fn quiet(&self) -> Quiet {
        self.quiet
    }

    /// Makes the data set of the samples, `what`, of each film.
    ///
    /// # Errors
    /// With the folder that is not empty, the frame or the truth that is wrong; no samples.
    pub fn run(
        self,
        session: &mut Session,
        what: &str,
        samples_of: impl Fn(&TrueFilm) -> Result<Vec<Sample>>,
    ) -> Result<Ending> {
        let Self { frames, output, json, .. } = self;
        check_folder(&output)?;
        let empty = fs::read_dir(&output).map_or(true, |mut entries| entries.next().is_none());
        ensure!(empty, "{}: there are files already; give a new folder", output.display());
        let films = TrueFilm::open_all(&frames)?;
        let samples: Vec<Vec<Sample>> = films.iter().map(samples_of).collect::<Result<_>>()?;
        let all: u64 = samples.iter().map(|samples| samples.len() as u64).sum();
        ensure!(all > 0, "no {what} in {} folders of frames", frames.len());
        let progress = session.progress(what, all);
        let mut report = CutOut { output, samples: 0, classes: BTreeMap::new() };
        for Sample { class, files } in samples.into_iter().flatten() {
            if session.interrupt().requested() {
                break;
            }
            for (from, to) in files {
                put(&from, &report.output.join(&class).join(to))?;
            }
            *report.classes.entry(class).or_default() += 1;
            report.samples += 1;
            progress.set(report.samples);
        }
        progress.finish();
        let ending = if report.samples < all { Ending::Partial } else { Ending::Complete };
        if ending == Ending::Partial {
            session.warn(format_args!("interrupted after {} of {all} {what}", report.samples));
        }
        for (class, count) in &report.classes {
            writeln!(session.output(), "{count:7}  {class}")?;
        }
        writeln!(
            session.output(),
            "{} {what} of {} classes in {}",
            report.samples,
            report.classes.len(),
            report.output.display()
        )?;
        session.conclude(json, &report, ending)
    }
}

/// Links a file, or copies it.
fn put(from: &Path, to: &Path) -> Result<()> {
    if let Some(folder) = to.parent() {
        fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    }
    if fs::hard_link(from, to).is_err() {
        fs::copy(from, to).with_context(|| from.display().to_string())?;
    }
    Ok(())
}
