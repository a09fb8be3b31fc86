//! Recognises the action in a folder of frames.

use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use clap::{Parser, ValueEnum};
use examples::score_rows::print_likeliest;
use ndarray::{Array3, Array5, ArrayView3};
use vision_models::{
    Checkpoint, ClassNames, ClipSampling, Crops, Options, Preprocessing, SlowOnly, SlowOnlyForm,
    list_frames, read_image, softmax,
};

/// Recognises the action in a folder of frames with SlowOnly: the five likeliest classes.
///
/// The probabilities are the mean over all clips and crops.
#[derive(Debug, Parser)]
#[command(version)]
struct Arguments {
    /// A folder of JPEG or PNG files, one a frame, in the order of their names.
    folder: PathBuf,
    /// The checkpoint.
    #[arg(long, value_name = "FILE")]
    weights: PathBuf,
    /// Whose network, pre-processing and choice of frames.
    #[arg(long, default_value = "slowonly_mm")]
    model: Model,
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
    /// Threads that share the work.
    #[arg(long, default_value_t = 1)]
    threads: usize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
enum Model {
    /// mmaction2's SlowOnly with a ResNet-50.
    SlowonlyMm,
    /// mmaction2's SlowOnly with a ResNet-18.
    SlowonlyR18Mm,
    /// PyTorchVideo's `slow_r50`.
    SlowonlyPtv,
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

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    ensure!(arguments.threads > 0, "--threads 0: give at least one");
    let frames = list_frames(&arguments.folder)?;
    let clips = sampling(&arguments).indices(frames.len())?;
    let preprocessing = preprocessing(&arguments);

    let form = match arguments.model {
        Model::SlowonlyMm => SlowOnlyForm::MmAction2,
        Model::SlowonlyR18Mm => SlowOnlyForm::MmAction2Depth18,
        Model::SlowonlyPtv => SlowOnlyForm::PyTorchVideo,
    };
    let size = [arguments.length, preprocessing.crop, preprocessing.crop];
    let options = Options { threads: arguments.threads, ..Options::default() };
    let weights = Checkpoint::open(&arguments.weights)
        .with_context(|| arguments.weights.display().to_string())?;
    let mut network = SlowOnly::load(form, weights, size, options)?;

    let mut sums: Vec<f32> = Vec::new();
    let mut views = 0.0;
    for clip in clips {
        let read = clip.iter().filter_map(|&index| frames.get(index)).map(read_image);
        let crops = crops(&preprocessing, &read.collect::<Result<Vec<_>, _>>()?)?;
        for scores in network.infer(crops.view())?.logits.outer_iter() {
            let probabilities = softmax(&scores.to_vec());
            sums.resize(probabilities.len(), 0.0);
            for (sum, probability) in sums.iter_mut().zip(probabilities) {
                *sum += probability;
            }
            views += 1.0;
        }
    }
    let means: Vec<f32> = sums.iter().map(|sum| sum / views).collect();
    let names = match &arguments.names {
        Some(file) => Some(ClassNames::read(file)?),
        None => Some(ClassNames::hri30()).filter(|names| names.names().len() == means.len()),
    };
    print_likeliest(&means, names.as_ref())
}

fn crops(preprocessing: &Preprocessing, frames: &[Array3<u8>]) -> Result<Array5<f32>> {
    let views: Vec<ArrayView3<'_, u8>> = frames.iter().map(|frame| frame.view()).collect();
    Ok(preprocessing.clip(&views)?)
}

fn sampling(arguments: &Arguments) -> ClipSampling {
    let Arguments { length, interval, clips, .. } = *arguments;
    match (arguments.model, arguments.before1) {
        (Model::SlowonlyPtv, _) => ClipSampling::PyTorchVideo { length },
        (_, true) => ClipSampling::Mmaction2Before1 { length, interval, clips },
        (_, false) => ClipSampling::Mmaction2 { length, interval, clips },
    }
}

fn preprocessing(arguments: &Arguments) -> Preprocessing {
    let crops = match arguments.crops {
        CropsOption::Centre => Crops::Centre,
        CropsOption::Three => Crops::Three,
        CropsOption::Ten => Crops::Ten,
    };
    let library = match arguments.model {
        Model::SlowonlyPtv => Preprocessing::PYTORCHVIDEO,
        Model::SlowonlyMm | Model::SlowonlyR18Mm => Preprocessing::MMACTION2,
    };
    Preprocessing { crops, ..library }
}
