//! Evaluation of trained models, as in the paper's Table I.

use std::{collections::BTreeMap, io::Write, path::PathBuf};

use anyhow::{Result, ensure};
use clap::{Args, ValueEnum};
use human_perception::{
    Watch,
    learning::{
        confusion_figure::confusion_figure,
        evaluation::{Evaluation, score_table},
        split::Part,
    },
    networks::folders::{LabelledImage, Unreadable},
    surface::{
        features::{Flips, path_within},
        model::SurfaceModel,
    },
};
use serde::Serialize;

use super::options::ModelWeights;
use crate::{
    program::{Ending, OutputFile, Printing, Session, Threads, check_folder},
    vision::choices::with_option,
};

/// Classifies images of known classes by each model, and prints accuracy and confusion matrices.
///
/// --output FOLDER writes a picture of each confusion matrix, the scores of every image and the result as JSON.
#[derive(Args, Debug)]
pub struct Evaluate {
    /// A folder with a folder of JPEG or PNG files for each class.
    folder: PathBuf,
    /// The folder of the trained model.
    #[arg(long, value_name = "FOLDER")]
    model: PathBuf,
    #[command(flatten)]
    weights: ModelWeights,
    /// The folder for features, which later runs reuse.
    #[arg(long, value_name = "FOLDER")]
    cache: Option<PathBuf>,
    /// The images of the folder to take: a part of the training's split, or all.
    #[arg(long, default_value = "test")]
    part: PartOption,
    /// Write pictures, scores and the result into this folder.
    #[arg(long, short, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Stop at the first image that cannot be read.
    #[arg(long)]
    strict: bool,
    #[command(flatten)]
    threads: Threads,
    #[command(flatten)]
    printing: Printing,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum PartOption {
    /// The tenth of the images that no training has seen.
    Test,
    /// The fifth of the images for validation.
    Validation,
    /// Images of the training.
    Training,
    /// Every image.
    All,
}

/// The JSON object of `--json`.
#[derive(Default, Serialize)]
struct Evaluated {
    classes: Vec<String>,
    unreadable: usize,
    /// Evaluations by the models' names.
    models: BTreeMap<String, Evaluation>,
}

impl Evaluate {
    /// Evaluates every model.
    ///
    /// # Errors
    /// The folder, the class, the image or the option that is wrong.
    pub fn run(self, session: &mut Session) -> Result<Ending> {
        self.output.as_deref().map(check_folder).transpose()?;
        let model = SurfaceModel::read(&self.model)?;
        let watch = &mut session.watch();
        let images = self.images(&model, watch)?;
        let threads = self.threads.count();
        let sources = model
            .sources(&self.weights.weights, self.cache.as_ref(), threads, watch)
            .map_err(|error| with_option(error, ModelWeights::OPTION))?;
        let mut report = Evaluated { classes: model.classes.clone(), ..Evaluated::default() };
        let mut unreadable = Unreadable::new(self.strict);
        let mut files = Vec::new();
        for (network, mut source) in model.networks.iter().zip(sources) {
            let features = source.of_images(&images, Flips::None, &mut unreadable, watch)?;
            let Some(features) = features else {
                session.warn("interrupted before the end");
                return session.conclude(self.printing, &report, Ending::Partial);
            };
            for (name, decider) in network.deciders() {
                let scores = features.scores(&decider)?;
                let evaluation = features.evaluate(model.classes.len(), &scores)?;
                writeln!(session.output(), "\n{name}")?;
                evaluation.write_confusion(session.output(), &model.classes)?;
                if self.output.is_some() {
                    let figure = confusion_figure(&name, &model.classes, &evaluation.confusion)?;
                    files.push((format!("confusion-{name}.svg"), figure));
                    let samples = features.paths.iter().zip(&features.labels).zip(&scores);
                    let samples = samples.map(|((path, label), scores)| {
                        (path_within(&self.folder, path), *label, scores.as_slice())
                    });
                    let table = score_table("image", &model.classes, samples);
                    files.push((format!("scores-{name}.csv"), table));
                }
                report.models.insert(name, evaluation);
            }
        }
        report.unreadable = unreadable.count();
        writeln!(session.output(), "\nmodel                 images  accuracy, %")?;
        for (name, evaluation) in &report.models {
            let percent = 100.0 * evaluation.accuracy.unwrap_or(f64::NAN);
            writeln!(session.output(), "{name:<20} {:7}      {percent:7.2}", evaluation.samples)?;
        }
        if let Some(folder) = &self.output {
            files.push(("evaluation.json".into(), serde_json::to_string_pretty(&report)? + "\n"));
            std::fs::create_dir_all(folder)?;
            for (name, contents) in files {
                OutputFile::write_whole(folder.join(name), contents.as_bytes())?;
            }
        }
        session.conclude(self.printing, &report, Ending::Complete)
    }

    /// The images of the selected part.
    fn images(&self, model: &SurfaceModel, watch: &mut Watch<'_>) -> Result<Vec<LabelledImage>> {
        let part = match self.part {
            PartOption::All => None,
            PartOption::Test => Some(Part::Test),
            PartOption::Validation => Some(Part::Validation),
            PartOption::Training => Some(Part::Training),
        };
        let images = model.images_of(&self.folder, part, watch)?;
        ensure!(
            !images.is_empty(),
            "{}: no image is of this part of the training's split; --part all takes every image",
            self.folder.display()
        );
        Ok(images)
    }
}
