//! Training of the paper's models.

use std::{collections::BTreeMap, io::Write, path::PathBuf};

use anyhow::Result;
use clap::{Args, ValueEnum};
use human_perception::{
    learning::{split::Part, twins::Twins},
    networks::folders::Unreadable,
    surface::{
        features::{FeatureSource, Features, Flips},
        model::SurfaceModel,
        training::{ImageParts, TrainingSettings},
    },
};
use serde::Serialize;
use vision_models::{ClassWeights, Loss, SvmSettings};

use super::options::Backbones;
use crate::{
    learning::head_options::HeadOptions,
    program::{Ending, Printing, Seed, Session, Threads, check_folder},
    vision::choices::with_option,
};

/// Trains a new last layer and a support vector machine over the features of each network.
///
/// The images of each class are split by the seed: 70 % to train with, 20 % for validation, 10 % for the test.
#[derive(Args, Debug)]
pub struct Train {
    /// A folder with a folder of JPEG or PNG files for each class.
    folder: PathBuf,
    /// The folder for the trained model.
    #[arg(long, short, value_name = "FOLDER")]
    output: PathBuf,
    #[command(flatten)]
    backbones: Backbones,
    /// The folder for features, which later runs reuse. An interrupted run keeps them.
    #[arg(long, value_name = "FOLDER")]
    cache: Option<PathBuf>,
    /// Train without mirror images of the images.
    #[arg(long)]
    no_flips: bool,
    /// The penalty of the support vector machine.
    #[arg(long, default_value = "squared-hinge")]
    loss: LossOption,
    /// The weight of the penalty against the margin.
    #[arg(long, default_value_t = 1.0, allow_negative_numbers = true)]
    cost: f64,
    /// Give each class the same weight in the support vector machine, whatever its number of images.
    #[arg(long)]
    balanced: bool,
    #[command(flatten)]
    head: HeadOptions,
    /// Stop at the first image that cannot be read.
    #[arg(long)]
    strict: bool,
    #[command(flatten)]
    seed: Seed,
    #[command(flatten)]
    threads: Threads,
    #[command(flatten)]
    printing: Printing,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum LossOption {
    /// The paper's L1-SVM.
    Hinge,
    /// The paper's L2-SVM.
    SquaredHinge,
}

/// The JSON object of `--json`.
#[derive(Default, Serialize)]
struct Trained {
    classes: Vec<String>,
    training_images: usize,
    validation_images: usize,
    test_images: usize,
    /// Number of images whose content is also in another part.
    in_two_parts: usize,
    unreadable: usize,
    /// Reports by the models' names.
    models: BTreeMap<String, ModelReport>,
}

#[derive(Serialize)]
struct ModelReport {
    training_accuracy: Option<f64>,
    validation_accuracy: Option<f64>,
    /// Largest duality gap of the support vector machine's planes, as a share of the objective.
    #[serde(skip_serializing_if = "Option::is_none")]
    gap: Option<f64>,
}

impl Train {
    /// Trains and writes the model.
    ///
    /// # Errors
    /// The folder, the class, the image or the option that is wrong.
    pub fn run(self, session: &mut Session) -> Result<Ending> {
        check_folder(&self.output)?;
        let watch = &mut session.watch();
        let settings = self.settings()?;
        let networks = self.backbones.networks()?;
        let parts = ImageParts::of_folder(&self.folder, self.seed.seed, watch)?;
        let in_two_parts = tell_twins(&parts, session)?;
        let mut sources = Vec::new();
        for (depth, weights) in networks {
            let identity = weights.identity(watch)?;
            let threads = self.threads.count();
            let source =
                FeatureSource::new(depth, (weights, &identity), self.cache.as_ref(), threads)?;
            sources.push((depth, identity, source));
        }
        let mut report = Trained {
            classes: parts.classes.clone(),
            training_images: parts.training.len(),
            validation_images: parts.validation.len(),
            test_images: parts.of_paths.values().filter(|part| **part == Part::Test).count(),
            in_two_parts,
            ..Trained::default()
        };
        let mut trained = Vec::new();
        let mut unreadable = Unreadable::new(self.strict);
        writeln!(session.output(), "model               training  validation   (accuracy, %)")?;
        for (depth, identity, mut source) in sources {
            let flips = if self.no_flips { Flips::None } else { Flips::Horizontal };
            let training = source.of_images(&parts.training, flips, &mut unreadable, watch)?;
            let Some(training) = training else { return self.interrupted(session, &report) };
            let validation =
                source.of_images(&parts.validation, Flips::None, &mut unreadable, watch)?;
            let Some(validation) = validation else { return self.interrupted(session, &report) };
            let (network, gap) = parts.train((depth, identity), &training, &settings, watch)?;
            for (name, decider) in network.deciders() {
                let accuracy = |features: &Features| -> Result<Option<f64>> {
                    let scores = features.scores(&decider)?;
                    Ok(features.evaluate(parts.classes.len(), &scores)?.accuracy)
                };
                let (of_training, of_validation) = (accuracy(&training)?, accuracy(&validation)?);
                let percent = |share: Option<f64>| 100.0 * share.unwrap_or(f64::NAN);
                writeln!(
                    session.output(),
                    "{name:<20} {:7.2}     {:7.2}",
                    percent(of_training),
                    percent(of_validation)
                )?;
                let own = ModelReport {
                    training_accuracy: of_training,
                    validation_accuracy: of_validation,
                    gap: name.ends_with("+svm").then_some(gap),
                };
                report.models.insert(name, own);
            }
            trained.push(network);
        }
        report.unreadable = unreadable.count();
        let model =
            SurfaceModel { classes: parts.classes, parts: parts.of_paths, networks: trained };
        model.write(&self.output)?;
        writeln!(session.output(), "model: {}", self.output.display())?;
        session.conclude(self.printing, &report, Ending::Complete)
    }

    fn interrupted(&self, session: &mut Session, report: &Trained) -> Result<Ending> {
        session.warn("interrupted before the end: there is no model");
        session.conclude(self.printing, report, Ending::Partial)
    }

    fn settings(&self) -> Result<TrainingSettings> {
        let head = self.head.settings(self.seed.seed)?;
        let loss = match self.loss {
            LossOption::Hinge => Loss::Hinge,
            LossOption::SquaredHinge => Loss::SquaredHinge,
        };
        let class_weights =
            if self.balanced { ClassWeights::Balanced } else { ClassWeights::Equal };
        let svm = SvmSettings { loss, cost: self.cost, class_weights, ..SvmSettings::default() };
        svm.validate().map_err(|error| with_option(error.into(), ""))?;
        Ok(TrainingSettings { head, svm })
    }
}

/// Names the first image whose content is also in another part. Returns the number of such images.
fn tell_twins(parts: &ImageParts, session: &Session) -> Result<usize> {
    const SHOWN: usize = 3;
    let twins = parts.twins(&mut session.watch())?;
    for Twins { first, second } in twins.iter().take(SHOWN) {
        let (first, second) = (first.display(), second.display());
        session.warn(format_args!("{second} is the same picture as {first}, of another part"));
    }
    if !twins.is_empty() {
        session.warn(format_args!(
            "{} pictures are in more than one of the parts training, validation and test: accuracies are too high by \
             them",
            twins.len()
        ));
    }
    Ok(twins.len())
}
