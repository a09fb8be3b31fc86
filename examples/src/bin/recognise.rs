//! Recognises the action in a folder of frames.

use std::{
    path::{Path, PathBuf},
    process::ExitCode,
};

use anyhow::{Context, Result};
use clap::{Parser, ValueEnum};
use examples::program::{self, Ending, Json, Program, Quiet, ResultFile, Session, Threads};
use examples::vision::{
    choices::{self, with_option},
    results::Results,
};
use human_perception::{
    Error as PerceptionError, Watch,
    networks::{
        clip_stream::preprocessing_of,
        clips::read_clip,
        folders::images_in,
        open_weights,
        top_k::{ScoredClass, check_names, top_classes, write_top_classes},
    },
};
use serde::Serialize;
use vision_models::{
    ClassNames, ClipSampling, Crops, Options, Preprocessing, SlowOnly, SlowOnlyForm, softmax,
};

/// Recognises the action in a folder of frames with SlowOnly, and prints the five most probable
/// classes.
///
/// The probabilities are the mean over all clips and crops; after Ctrl-C over those up to there.
#[derive(Debug, Parser)]
#[command(version)]
struct Arguments {
    /// A folder of JPEG or PNG files, one a frame, in the order of their names.
    folder: PathBuf,
    /// The checkpoint.
    #[arg(long, value_name = "FILE")]
    weights: PathBuf,
    /// Whose network, pre-processing and choice of frames.
    #[arg(long, default_value = "slowonly_mm", value_parser = choices::slow_only())]
    model: SlowOnlyForm,
    /// The names of the classes, one a line; HRI30's if there are thirty.
    #[arg(long, value_name = "FILE")]
    names: Option<PathBuf>,
    /// Frames of a clip.
    #[arg(long, default_value_t = 8)]
    length: usize,
    /// Frames of the video from one of a clip to the next (mmaction2).
    #[arg(long, default_value_t = 4)]
    interval: usize,
    /// Clips of the video (mmaction2).
    #[arg(long, default_value_t = 1)]
    clips: usize,
    /// Choose the frames as mmaction2 before 1.0 does.
    #[arg(long)]
    before1: bool,
    /// The parts of the frames.
    #[arg(long, default_value = "centre")]
    crops: CropsOption,
    #[command(flatten)]
    threads: Threads,
    #[command(flatten)]
    result: ResultFile,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    quiet: Quiet,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum CropsOption {
    /// The middle.
    Centre,
    /// Both ends and the middle.
    Three,
    /// Corners and middle, and their mirror images.
    Ten,
}

/// The line of `--json`.
#[derive(Serialize)]
struct Recognised {
    /// Clips that were seen.
    clips: usize,
    /// Clips and crops whose probabilities were averaged.
    views: usize,
    classes: Vec<ScoredClass>,
}

/// The sum of the probabilities of all views.
#[derive(Default)]
struct Sums {
    probabilities: Vec<f32>,
    views: usize,
}

impl Sums {
    fn add(&mut self, logits: &[f32]) {
        let probabilities = softmax(logits);
        self.probabilities.resize(probabilities.len(), 0.0);
        for (sum, probability) in self.probabilities.iter_mut().zip(probabilities) {
            *sum += probability;
        }
        self.views += 1;
    }

    fn means(&self) -> Vec<f32> {
        self.probabilities.iter().map(|sum| sum / self.views as f32).collect()
    }
}

impl Program for Arguments {
    fn quiet(&self) -> Quiet {
        self.quiet
    }

    fn run(self, session: &mut Session) -> Result<Ending> {
        let mut results = Results::begin(&self.result)?;
        let watch = &mut session.watch();
        let frames = images_in(&self.folder, watch)?;
        let clips =
            self.sampling().indices(frames.len()).map_err(|error| with_option(error.into(), ""))?;
        let names = self.names.as_deref().map(read_names).transpose()?;
        let preprocessing = self.preprocessing();
        let mut network = self.load(&preprocessing, watch)?;
        let names = match (names, &self.names) {
            (Some(names), Some(file)) => {
                check_names(file, &names, network.classes())?;
                Some(names)
            }
            _ => Some(ClassNames::hri30()).filter(|names| names.names().len() == network.classes()),
        };

        let progress = session.progress("clips", clips.len() as u64);
        let mut sums = Sums::default();
        let mut seen = 0;
        for clip in &clips {
            let Some(crops) = read_clip(&preprocessing, &frames, clip, watch)? else { break };
            for logits in network.infer(crops.view())?.logits.outer_iter() {
                sums.add(&logits.to_vec());
            }
            seen += 1;
            progress.set(seen as u64);
        }
        progress.finish();
        if seen == 0 {
            session.interrupt().check()?;
        }
        let ending = if seen < clips.len() { Ending::Partial } else { Ending::Complete };
        if ending == Ending::Partial {
            session.warn(format_args!("interrupted after {seen} of {} clips", clips.len()));
        }
        let classes = top_classes(&sums.means(), names.as_ref());
        write_top_classes(results.writer(session), &classes)?;
        results.keep(ending)?;
        let result = Recognised { clips: seen, views: sums.views, classes };
        session.conclude(self.json, &result, ending)
    }
}

fn read_names(file: &Path) -> Result<ClassNames> {
    ClassNames::read(file).with_context(|| file.display().to_string())
}

impl Arguments {
    fn load(&self, preprocessing: &Preprocessing, watch: &mut Watch<'_>) -> Result<SlowOnly> {
        let size = [self.length, preprocessing.crop, preprocessing.crop];
        let options = Options { threads: self.threads.count(), ..Options::default() };
        SlowOnly::load(self.model, open_weights(&self.weights, watch)?, size, options)
            .map_err(|error| with_option(PerceptionError::weights(&self.weights)(error), ""))
    }

    fn sampling(&self) -> ClipSampling {
        let Self { length, interval, clips, .. } = *self;
        match (self.model, self.before1) {
            (SlowOnlyForm::PyTorchVideo, _) => ClipSampling::PyTorchVideo { length },
            (_, true) => ClipSampling::Mmaction2Before1 { length, interval, clips },
            (_, false) => ClipSampling::Mmaction2 { length, interval, clips },
        }
    }

    fn preprocessing(&self) -> Preprocessing {
        let crops = match self.crops {
            CropsOption::Centre => Crops::Centre,
            CropsOption::Three => Crops::Three,
            CropsOption::Ten => Crops::Ten,
        };
        Preprocessing { crops, ..preprocessing_of(self.model) }
    }
}

fn main() -> ExitCode {
    program::main::<Arguments>()
}
