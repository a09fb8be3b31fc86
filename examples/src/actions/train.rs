//! Training of a recogniser.

use std::{io::Write, path::PathBuf};

use anyhow::{Context, Result};
use clap::Args;
use human_perception::{
    Watch,
    actions::{features::ClipFeatures, training::ClipParts},
    learning::split::Part,
};
use serde::Serialize;
use vision_models::ClassNames;

use super::options::NetworkOptions;
use crate::{
    learning::head_options::HeadOptions,
    program::{Ending, Printing, Seed, Session, Threads, check_folder},
};

/// Trains a new last layer of a SlowOnly on clips, each a folder of frames.
#[derive(Args, Debug)]
pub struct Train {
    /// A folder with a folder for each class, which has a folder of JPEG or PNG files for each clip. If a --list is
    /// given, a folder with a folder for each clip.
    folder: PathBuf,
    /// The folder for the trained model.
    #[arg(long, short, value_name = "FOLDER")]
    output: PathBuf,
    #[command(flatten)]
    network: NetworkOptions,
    /// Train with the clips of this list, a name and a class in each line, instead of a part of the folder.
    #[arg(long, value_name = "FILE")]
    list: Option<PathBuf>,
    /// The classes of the list, one a line; HRI30's in alphabetical order if it is not given.
    #[arg(long, value_name = "FILE", requires = "list")]
    names: Option<PathBuf>,
    /// The number of HRI30's split: of 98 clips of a class, 28, 21 or 35 are for the test.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=3), conflicts_with = "list")]
    split: u8,
    /// The folder for features, which later runs reuse. An interrupted run keeps them.
    #[arg(long, value_name = "FOLDER")]
    cache: Option<PathBuf>,
    /// Train without mirror images of the clips. A mirror image of walking left is one of walking right.
    #[arg(long)]
    no_flips: bool,
    #[command(flatten)]
    head: HeadOptions,
    #[command(flatten)]
    seed: Seed,
    #[command(flatten)]
    threads: Threads,
    #[command(flatten)]
    printing: Printing,
}

/// The JSON object of `--json`.
#[derive(Default, Serialize)]
struct Trained {
    classes: Vec<String>,
    training_clips: usize,
    test_clips: usize,
    training_accuracy: Option<f64>,
    /// Mean cross-entropy of the last epoch.
    loss: Option<f64>,
}

/// The names of a list's classes.
pub(super) fn class_names(file: Option<&PathBuf>) -> Result<ClassNames> {
    let Some(file) = file else { return Ok(ClassNames::hri30()) };
    ClassNames::read(file).with_context(|| file.display().to_string())
}

impl Train {
    /// Trains and writes the model.
    ///
    /// # Errors
    /// The folder, the class, the clip or the option that is wrong.
    pub fn run(self, session: &mut Session) -> Result<Ending> {
        check_folder(&self.output)?;
        let watch = &mut session.watch();
        let settings = self.head.settings(self.seed.seed)?;
        let (weights, window) = self.network.chosen()?;
        let parts = self.parts(watch)?;
        let identity = weights.identity(watch)?;
        let threads = self.threads.count();
        let source = (weights, &identity);
        let mut source = ClipFeatures::new(window, source, self.cache.as_ref(), threads)?;
        let mut report = Trained {
            classes: parts.classes.clone(),
            training_clips: parts.training.len(),
            test_clips: parts.of_names.values().filter(|part| **part == Part::Test).count(),
            ..Trained::default()
        };
        let how = (!self.no_flips, &settings);
        let Some(trained) = parts.train(&mut source, identity.clone(), how, watch)? else {
            session.warn("interrupted before the end: there is no model");
            return session.conclude(self.printing, &report, Ending::Partial);
        };
        trained.model.write(&self.output)?;
        (report.training_accuracy, report.loss) = (trained.accuracy, trained.loss);
        writeln!(
            session.output(),
            "trained with {} clips of {} classes: {:.2} % of them right, cross-entropy {:.4}\nmodel: {}",
            report.training_clips,
            report.classes.len(),
            100.0 * report.training_accuracy.unwrap_or(f64::NAN),
            report.loss.unwrap_or(f64::NAN),
            self.output.display()
        )?;
        session.conclude(self.printing, &report, Ending::Complete)
    }

    /// The clips to train with, and the role of each clip of the folder.
    fn parts(&self, watch: &mut Watch<'_>) -> Result<ClipParts> {
        Ok(match &self.list {
            Some(list) => {
                ClipParts::of_list(&self.folder, list, &class_names(self.names.as_ref())?)?
            }
            None => ClipParts::of_folders(&self.folder, self.split, self.seed.seed, watch)?,
        })
    }
}
