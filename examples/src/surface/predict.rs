//! Classifies images by trained models.

use std::path::PathBuf;

use anyhow::Result;
use clap::Args;
use serde::Serialize;
use vision_models::top_k;

use human_perception::{
    networks::folders::{LabelledImage, Unreadable},
    surface::{features::Flips, model::SurfaceModel},
};

use super::options::ModelWeights;
use crate::{
    program::{Ending, Json, Quiet, ResultFile, Session, Threads, shown},
    vision::{choices::with_option, results::Results},
};

/// Classifies images by each model.
///
/// An image that cannot be read is named on standard error and left out; the exit status is then 1.
#[derive(Args, Debug)]
pub struct Predict {
    /// JPEG or PNG files.
    #[arg(required = true)]
    images: Vec<PathBuf>,
    /// The folder of the trained model.
    #[arg(long, value_name = "FOLDER")]
    model: PathBuf,
    #[command(flatten)]
    weights: ModelWeights,
    /// Stop at the first image that cannot be read.
    #[arg(long)]
    strict: bool,
    #[command(flatten)]
    threads: Threads,
    #[command(flatten)]
    result: ResultFile,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    quiet: Quiet,
}

/// The line of `--json`.
#[derive(Default, Serialize)]
struct Predicted {
    classes: Vec<String>,
    images: Vec<Prediction>,
    unreadable: usize,
}

#[derive(Serialize)]
struct Prediction {
    image: PathBuf,
    model: String,
    class: String,
    /// In the order of the classes.
    scores: Vec<f32>,
}

impl Predict {
    /// The option `--quiet`.
    pub fn quiet(&self) -> Quiet {
        self.quiet
    }

    /// Classifies every image.
    ///
    /// # Errors
    /// With the file or the option that is wrong.
    pub fn run(self, session: &mut Session) -> Result<Ending> {
        let mut results = Results::begin(&self.result)?;
        let model = SurfaceModel::read(&self.model)?;
        let threads = self.threads.count();
        let watch = &mut session.watch();
        let sources = model
            .sources(&self.weights.weights, None, threads, watch)
            .map_err(|error| with_option(error, ModelWeights::OPTION))?;
        let images: Vec<LabelledImage> =
            self.images.into_iter().map(|path| LabelledImage { path, label: 0 }).collect();
        let mut report = Predicted { classes: model.classes.clone(), ..Predicted::default() };
        let mut unreadable = Unreadable::new(self.strict);
        let mut ending = Ending::Complete;
        for (network, mut source) in model.networks.iter().zip(sources) {
            let features = source.of_images(&images, Flips::None, &mut unreadable, watch)?;
            let Some(features) = features else {
                ending = Ending::Partial;
                break;
            };
            for (name, decider) in network.deciders() {
                for (path, row) in features.paths.iter().zip(features.rows.outer_iter()) {
                    let scores = decider.scores(row)?;
                    let best = top_k(&scores, 1).first().copied().unwrap_or_default();
                    let class = model.classes.get(best).cloned().unwrap_or_default();
                    let out = results.writer(session);
                    writeln!(out, "{}: {class} ({name}: {scores:.3?})", shown(path))?;
                    let (image, model) = (path.clone(), name.clone());
                    report.images.push(Prediction { image, model, class, scores });
                }
            }
        }
        report.unreadable = unreadable.count();
        if ending == Ending::Partial {
            session.warn("interrupted: the results are of the networks up to there");
        } else if report.unreadable > 0 {
            ending = Ending::Failed;
        }
        results.keep(ending)?;
        session.conclude(self.json, &report, ending)
    }
}
