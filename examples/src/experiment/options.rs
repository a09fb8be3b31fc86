//! Options of every experiment.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use clap::Args;
use moca_simulation::experiment::{Conditions, Job, Sight};
use moca_simulation::plant::Drive;

use crate::program::{Ending, OutputFile, Printing, Seed, Threads, check_folder};
use crate::shards::ShardOptions;

/// Options of every experiment.
#[derive(Args, Clone, Debug)]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of the command line")]
pub(super) struct Common {
    /// Number of random cases.
    #[arg(long, value_name = "COUNT", default_value_t = 100, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    cases: u64,
    /// A robot that follows velocities exactly and at once, in place of one under torques.
    #[arg(long)]
    kinematic: bool,
    /// Play the paper's own controller: its three levels, the period as the horizon, and no posture, margin, lead,
    /// following distance or separation.
    #[arg(long)]
    paper: bool,
    /// Find the person's joints in rendered frames with depth, as `perceive` does, in place of a camera model. A case
    /// takes some seconds more.
    #[arg(long)]
    pixels: bool,
    /// Play these recordings (JSON Lines, as `record` and `perceive` make them), a case each, in place of random
    /// people.
    #[arg(long, value_name = "FILE", num_args = 1.., conflicts_with_all = ["cases", "pixels"])]
    pub(super) recording: Vec<PathBuf>,
    /// The case that the page shows, from 0.
    #[arg(long, value_name = "CASE", default_value_t = 0)]
    pub(super) show: u64,
    /// The folder of figure and page, made if it does not exist.
    #[arg(long, short, value_name = "FOLDER", default_value = "report")]
    output: PathBuf,
    /// Write no figure and no page.
    #[arg(long)]
    no_report: bool,
    #[command(flatten)]
    pub(super) shards: ShardOptions,
    /// Seed and threads.
    #[command(flatten)]
    seed: Seed,
    #[command(flatten)]
    pub(super) threads: Threads,
    #[command(flatten)]
    pub(super) printing: Printing,
}

impl Common {
    /// The job: recordings with these digests, or random cases of this duration.
    pub(super) fn job(&self, duration: f64, recordings: Vec<String>) -> Job {
        let conditions = Conditions {
            drive: if self.kinematic { Drive::Kinematic } else { Drive::Torque },
            sight: if self.pixels { Sight::Pixels } else { Sight::Modelled },
            paper: self.paper,
        };
        Job { seed: self.seed.seed, cases: self.cases, duration, conditions, recordings }
    }

    /// The folder of figure and page, unless they are not wanted.
    pub(super) fn figures(&self) -> Option<&Path> {
        (!self.no_report).then_some(&self.output)
    }

    /// Makes the folder of figure and page before the work, so that a wrong place is known early.
    ///
    /// # Errors
    /// A folder that cannot be made.
    pub(super) fn prepare(&self) -> Result<()> {
        self.figures().map_or(Ok(()), make_folder)
    }
}

/// Parses the duration of a case \[s\].
///
/// # Errors
/// A number of seconds in which the person cannot work and leave, or no number.
pub(super) fn case_duration(text: &str) -> Result<f64, &'static str> {
    let value = text.parse().ok();
    value.filter(|value| (20.0..=600.0).contains(value)).ok_or("give 20 to 600 seconds")
}

/// Makes a folder if it does not exist.
///
/// # Errors
/// A folder that cannot be made.
pub fn make_folder(folder: &Path) -> Result<()> {
    check_folder(folder)?;
    fs::create_dir_all(folder)
        .with_context(|| format!("cannot make the folder {}", folder.display()))
}

/// Writes a figure or a page, named `*.partial.*` unless the cases were played to their end.
///
/// # Errors
/// A file that cannot be written.
pub(super) fn write_figure(path: &Path, text: &str, ending: Ending) -> Result<()> {
    let mut file = OutputFile::create(path)?;
    file.push(text.as_bytes())?;
    if ending == Ending::Partial {
        file.keep_partial()?;
    } else {
        file.keep()?;
    }
    Ok(())
}
