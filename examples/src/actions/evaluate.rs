//! Evaluation of a recogniser.

use std::path::PathBuf;

use anyhow::{Result, ensure};
use clap::{Args, ValueEnum};
use vision_models::Crops;

use human_perception::{
    Watch,
    actions::{
        clips::{ClipSet, LabelledClip},
        evaluated::{Evaluated, EvaluationJob, ScoredClip},
        features::ClipFeatures,
        model::ActionModel,
        window::Views,
    },
    learning::split,
};

use super::{options::ModelWeights, train::class_names};
use crate::{
    program::{Ending, Printing, Session, Threads, check_folder},
    shards::{Part, ShardOptions},
    vision::choices::with_option,
};

/// Name of the program in shard files.
pub const PROGRAM: &str = "actions evaluate";

/// Recognises clips of known classes, and prints top-1, top-5, and a report by class and by the paper's three types of
/// actions.
///
/// --output FOLDER writes a picture of the confusion matrix, the probabilities of every clip and the result as JSON.
#[derive(Args, Debug)]
pub struct Evaluate {
    /// Folder of the data set, as for `train`.
    folder: PathBuf,
    /// The folder of the trained model.
    #[arg(long, value_name = "FOLDER")]
    model: PathBuf,
    #[command(flatten)]
    weights: ModelWeights,
    /// Take the clips of this list, a name and a class in each line, instead of a part of the folder.
    #[arg(long, value_name = "FILE")]
    list: Option<PathBuf>,
    /// The classes of the list, one a line; HRI30's in alphabetical order if it is not given.
    #[arg(long, value_name = "FILE", requires = "list")]
    names: Option<PathBuf>,
    /// The clips of the folder to take: a part of the training's split, or all.
    #[arg(long, default_value = "test", conflicts_with = "list")]
    part: PartOption,
    /// Windows along each clip, 1 to 64; the probabilities are the mean over all.
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u16).range(1..=64))]
    clips: u16,
    /// The parts of the frames to use.
    #[arg(long, default_value = "three")]
    crops: CropsOption,
    /// The folder for features, which later runs reuse.
    #[arg(long, value_name = "FOLDER")]
    cache: Option<PathBuf>,
    /// Write picture, probabilities and the result into this folder.
    #[arg(long, short, value_name = "FOLDER", conflicts_with = "shard")]
    output: Option<PathBuf>,
    #[command(flatten)]
    shards: ShardOptions,
    #[command(flatten)]
    threads: Threads,
    #[command(flatten)]
    printing: Printing,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum PartOption {
    /// Clips that no training has seen.
    Test,
    /// Clips of the training.
    Training,
    /// Every clip.
    All,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum CropsOption {
    /// The middle part.
    Centre,
    /// Both ends and the middle.
    Three,
}

impl Evaluate {
    /// Evaluates the recogniser.
    ///
    /// # Errors
    /// The folder, the class, the clip or the option that is wrong.
    pub fn run(self, session: &mut Session) -> Result<Ending> {
        self.output.as_deref().map(check_folder).transpose()?;
        let file = self.shards.create()?;
        let model = ActionModel::read(&self.model)?;
        let watch = &mut session.watch();
        let all = self.clips(&model, watch)?;
        let (shard, cases) = (self.shards.shard(), all.len() as u64);
        let own = (0..).zip(all).filter(|(case, _)| shard.contains(*case));
        let mut clips: Vec<LabelledClip> = own.map(|(_, clip)| clip).collect();
        ensure!(!clips.is_empty(), "shard {shard} of {cases} clips is empty; take fewer shards");
        let weights = model.weights.weights(self.weights.weights.clone(), watch);
        let weights = weights.map_err(|error| with_option(error, ModelWeights::OPTION))?;
        let (threads, window) = (self.threads.count(), model.window.clone());
        let source = (weights, &model.weights);
        let mut source = ClipFeatures::new(window, source, self.cache.as_ref(), threads)?;
        let crops = match self.crops {
            CropsOption::Centre => Crops::Centre,
            CropsOption::Three => Crops::Three,
        };
        let views = Views { clips: self.clips.into(), crops };
        let features = source.of_clips(&clips, views, false, watch)?;
        let ending = if features.len() < clips.len() { Ending::Partial } else { Ending::Complete };
        if ending == Ending::Partial {
            session
                .interrupt()
                .check()
                .or_else(|error| if features.is_empty() { Err(error) } else { Ok(()) })?;
            let (done, all) = (features.len(), clips.len());
            session.warn(format_args!("interrupted after {done} of {all} clips"));
            clips.truncate(done);
        }
        let scores = model.of_clips(&features)?;
        let scored: Vec<ScoredClip> = clips
            .into_iter()
            .zip(scores)
            .map(|(clip, scores)| ScoredClip { name: clip.name, label: clip.label, scores })
            .collect();
        let job = self.job(&model);
        let report = Evaluated::of(&job, &scored)?;
        report.write(session.output())?;
        if ending == Ending::Complete {
            if let Some(folder) = &self.output {
                report.write_folder(folder, &job, &scored)?;
            }
            let results = shard.of(cases).zip(scored).collect();
            let program = PROGRAM.to_owned();
            ShardOptions::write(file, &Part { program, job, shard, cases, results, times: () })?;
        }
        session.conclude(self.printing, &report, ending)
    }

    /// The job that all shards share.
    fn job(&self, model: &ActionModel) -> EvaluationJob {
        EvaluationJob {
            classes: model.head.classes().to_vec(),
            window: model.window.clone(),
            weights: model.weights.clone(),
            windows: self.clips.into(),
            crops: format!("{:?}", self.crops),
            clips: if self.list.is_some() { "list".to_owned() } else { format!("{:?}", self.part) },
        }
    }

    /// The clips of the list, or of the selected part, with the model's classes.
    fn clips(&self, model: &ActionModel, watch: &mut Watch<'_>) -> Result<Vec<LabelledClip>> {
        if let Some(list) = &self.list {
            let set = ClipSet::of_list(&self.folder, list, &class_names(self.names.as_ref())?)?;
            return Ok(model.clips_of(set, None)?);
        }
        let part = match self.part {
            PartOption::All => None,
            PartOption::Test => Some(split::Part::Test),
            PartOption::Training => Some(split::Part::Training),
        };
        let clips = model.clips_of(ClipSet::of_folders(&self.folder, watch)?, part)?;
        ensure!(
            !clips.is_empty(),
            "{}: no clip is of this part of the training's split; --part all takes every clip",
            self.folder.display()
        );
        Ok(clips)
    }
}
