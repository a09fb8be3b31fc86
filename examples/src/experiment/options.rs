//! Options of every experiment.

use std::fs;
use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::Args;

use super::sight::Sight;
use crate::plant::Drive;
use crate::program::{Ending, Json, OutputFile, Quiet, Seed, Threads, check_folder};

/// What is the same in all cases of an experiment.
#[derive(Clone, Copy, Debug)]
pub struct Conditions {
    /// What the robot does with commands.
    pub drive: Drive,
    /// How the robot sees the person.
    pub sight: Sight,
}

/// Options of every experiment.
#[derive(Args, Clone, Debug)]
pub struct Common {
    /// How many random cases to play.
    #[arg(long, value_name = "COUNT", default_value_t = 100, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    pub cases: u64,
    /// A robot that follows velocities exactly and at once, in place of one that moves under torques.
    #[arg(long)]
    kinematic: bool,
    /// Find the person's joints in rendered frames with depth, as `perceive` does, in place of a model of the camera.
    /// A case takes some seconds more.
    #[arg(long)]
    pixels: bool,
    /// The folder of the figures, made if it is not there.
    #[arg(long, short, value_name = "FOLDER", default_value = "report")]
    output: PathBuf,
    /// Write no figures.
    #[arg(long)]
    no_report: bool,
    /// Random numbers and threads.
    #[command(flatten)]
    pub seed: Seed,
    #[allow(missing_docs)]
    #[command(flatten)]
    pub threads: Threads,
    #[allow(missing_docs)]
    #[command(flatten)]
    pub json: Json,
    #[allow(missing_docs)]
    #[command(flatten)]
    pub quiet: Quiet,
}

impl Common {
    /// What is the same in all cases.
    pub fn conditions(&self) -> Conditions {
        Conditions {
            drive: if self.kinematic { Drive::Kinematic } else { Drive::Torque },
            sight: if self.pixels { Sight::Pixels } else { Sight::Modelled },
        }
    }

    /// Makes the folder of the figures; before the work, so that a wrong place is known early.
    ///
    /// # Errors
    /// A folder that cannot be made.
    pub fn prepare(&self) -> Result<()> {
        if self.no_report {
            return Ok(());
        }
        let folder = &self.output;
        check_folder(folder)?;
        fs::create_dir_all(folder)
            .with_context(|| format!("cannot make the folder {}", folder.display()))
    }

    /// Writes files into it, named `*.partial.*` where the cases were not played to their end.
    ///
    /// # Errors
    /// Files that cannot be written.
    pub fn write(&self, files: &[(&str, String)], ending: Ending) -> Result<()> {
        if self.no_report {
            return Ok(());
        }
        for (name, text) in files {
            let mut file = OutputFile::create(self.output.join(name))?;
            file.push(text.as_bytes())?;
            if ending == Ending::Partial {
                file.keep_partial()?;
            } else {
                file.keep()?;
            }
        }
        Ok(())
    }

    /// Returns true if figures are wanted.
    pub fn reports(&self) -> bool {
        !self.no_report
    }

    /// The folder of the figures.
    pub fn folder(&self) -> &std::path::Path {
        &self.output
    }
}
