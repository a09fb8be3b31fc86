//! Trains a recogniser.

use std::{collections::BTreeMap, io::Write, path::PathBuf};

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use ndarray::{Array2, ArrayView2, Axis, concatenate, s};
use serde::Serialize;
use vision_models::{Action, ClassNames, LinearHead};

use human_perception::{
    Watch,
    actions::{
        clips::{ClipSet, LabelledClip},
        features::ClipFeatures,
        model::ActionModel,
        window::Views,
    },
    learning::{
        evaluation::Evaluation,
        split::{Part, Shares, split},
    },
};

use super::options::NetworkOptions;
use crate::{
    learning::head_options::HeadOptions,
    program::{Ending, Json, ProgramError, Quiet, Seed, Session, Threads, check_folder},
};

/// Clips of a class in HRI30, and how many of them each split tests with.
const OF_CLASS: f64 = 98.0;
const TESTED: [f64; 3] = [28.0, 21.0, 35.0];

/// Trains a new last layer of a SlowOnly on clips, each a folder of frames.
#[derive(Args, Debug)]
pub struct Train {
    /// A folder with a folder for each class, which has a folder of JPEG or PNG files for each clip. With --list, a
    /// folder with a folder for each clip.
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
    /// Which of HRI30's splits: of 98 clips of a class, 28, 21 or 35 are for the test.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=3), conflicts_with = "list")]
    split: u8,
    /// The folder for features, which later runs take from there. An interrupted run keeps them.
    #[arg(long, value_name = "FOLDER")]
    cache: Option<PathBuf>,
    /// Train with the clips as they are, without their mirror images. A mirror image of walking left is of walking right.
    #[arg(long)]
    no_flips: bool,
    #[command(flatten)]
    head: HeadOptions,
    #[command(flatten)]
    seed: Seed,
    #[command(flatten)]
    threads: Threads,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    quiet: Quiet,
}

/// The line of `--json`.
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
    /// The option `--quiet`.
    pub fn quiet(&self) -> Quiet {
        self.quiet
    }

    /// Trains, and writes the model.
    ///
    /// # Errors
    /// With the folder, the class, the clip or the option that is wrong.
    pub fn run(self, session: &mut Session) -> Result<Ending> {
        check_folder(&self.output)?;
        let watch = &mut session.watch();
        let settings = self.head.settings(self.seed.seed)?;
        let (weights, window) = self.network.chosen()?;
        let (ClipSet { classes, clips }, parts) = self.clips(watch)?;
        let identity = weights.identity(watch)?;
        let threads = self.threads.count();
        let source = (weights, &identity);
        let mut source = ClipFeatures::new(window.clone(), source, self.cache.as_ref(), threads)?;
        let features = source.of_clips(&clips, Views::MIDDLE, !self.no_flips, watch)?;
        let test_clips = parts.values().filter(|part| **part == Part::Test).count();
        let mut report =
            Trained { classes, training_clips: clips.len(), test_clips, ..Trained::default() };
        if features.len() < clips.len() {
            session.warn("interrupted before the end: there is no model");
            return session.conclude(self.json, &report, Ending::Partial);
        }
        let (rows, labels) = self.samples(&report.classes, &clips, &features)?;
        let progress = session.progress("last layer", settings.epochs as u64);
        let classes = report.classes.clone();
        let head = LinearHead::train(rows.view(), &labels, classes, &settings, |epoch| {
            report.loss = Some(epoch.loss);
            progress.set(epoch.number as u64);
            !session.interrupt().requested()
        })?;
        progress.finish();
        ensure!(!session.interrupt().requested(), ProgramError::Interrupted);
        let model = ActionModel { head, window, weights: identity, parts };
        let plain: Vec<Array2<f32>> =
            features.iter().map(|views| self.plain(views).to_owned()).collect();
        let scores = model.of_clips(&plain)?;
        let scored = scores.iter().map(Vec::as_slice);
        let samples = clips.iter().map(|clip| clip.label).zip(scored);
        report.training_accuracy = Evaluation::of(report.classes.len(), samples)?.accuracy;
        model.write(&self.output)?;
        writeln!(
            session.output(),
            "trained with {} clips of {} classes: {:.2} % of them right, cross-entropy {:.4}\nmodel: {}",
            clips.len(),
            report.classes.len(),
            100.0 * report.training_accuracy.unwrap_or(f64::NAN),
            report.loss.unwrap_or(f64::NAN),
            self.output.display()
        )?;
        session.conclude(self.json, &report, Ending::Complete)
    }

    /// The rows of all views with their classes. A mirrored view is of the class that a mirror shows, and left out where
    /// that is none of the classes.
    fn samples(
        &self,
        classes: &[String],
        clips: &[LabelledClip],
        features: &[Array2<f32>],
    ) -> Result<(Array2<f32>, Vec<usize>)> {
        let mirrored = |label: usize| {
            let name = classes.get(label)?;
            let name = Action::from_label(name).map_or(name.as_str(), |own| own.mirrored().name());
            classes.iter().position(|class| class == name)
        };
        let (mut rows, mut labels) = (Vec::new(), Vec::new());
        for (clip, views) in clips.iter().zip(features) {
            let plain = self.plain(views);
            let of_mirror = views.slice(s![plain.nrows().., ..]);
            labels.extend(vec![clip.label; plain.nrows()]);
            rows.push(plain);
            if let Some(label) = mirrored(clip.label) {
                labels.extend(vec![label; of_mirror.nrows()]);
                rows.push(of_mirror);
            }
        }
        Ok((concatenate(Axis(0), &rows)?, labels))
    }

    /// The views that are not mirrored.
    fn plain<'a>(&self, views: &'a Array2<f32>) -> ArrayView2<'a, f32> {
        let count = if self.no_flips { views.nrows() } else { views.nrows() / 2 };
        views.slice(s![..count, ..])
    }

    /// The clips to train with, and what each clip of the folder is for.
    fn clips(&self, watch: &mut Watch<'_>) -> Result<(ClipSet, BTreeMap<String, Part>)> {
        let names = || class_names(self.names.as_ref());
        if let Some(list) = &self.list {
            let ClipSet { classes, clips } = ClipSet::of_list(&self.folder, list, &names()?)?;
            for (label, class) in classes.iter().enumerate() {
                if !clips.iter().any(|clip| clip.label == label) {
                    bail!("{}: no clip of the class \"{class}\"", list.display());
                }
            }
            let parts = clips.iter().map(|clip| (clip.name.clone(), Part::Training)).collect();
            return Ok((ClipSet { classes, clips }, parts));
        }
        let ClipSet { classes, mut clips } = ClipSet::of_folders(&self.folder, watch)?;
        let labels: Vec<usize> = clips.iter().map(|clip| clip.label).collect();
        let tested = TESTED.get(usize::from(self.split - 1)).copied().unwrap_or_default();
        let shares = Shares { validation: 0.0, test: tested / OF_CLASS };
        let parts = split(&labels, &classes, shares, self.seed.seed)
            .with_context(|| self.folder.display().to_string())?;
        let parts: BTreeMap<String, Part> =
            clips.iter().map(|clip| clip.name.clone()).zip(parts).collect();
        clips.retain(|clip| parts.get(&clip.name) == Some(&Part::Training));
        Ok((ClipSet { classes, clips }, parts))
    }
}
