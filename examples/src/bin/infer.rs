//! Runs a network on arrays, and says how long it takes.

use std::{
    path::{Path, PathBuf},
    time::Instant,
};

use anyhow::{Context, Result, ensure};
use clap::{Parser, ValueEnum};
use ndarray::{Array2, Array4, Array5, ArrayD, Ix4, Ix5};
use ndarray_npy::{read_npy, write_npy};
use vision_models::{
    Checkpoint, Error, Options, ResNet, ResNetDepth, Scores, SlowFast, SlowOnly, SlowOnlyForm,
};

/// Runs a network on an array of normalised images or clips.
///
/// Prints the median and the minimum time of an inference (of the whole batch) and the rate that
/// the median means, counting the multiplications and additions of the plain convolutions.
#[derive(Debug, Parser)]
#[command(version)]
struct Arguments {
    /// The network.
    #[arg(long)]
    model: Model,
    /// The checkpoint: safetensors, or PyTorch's .pth, .pt, .pyth. It says how many classes.
    #[arg(long, value_name = "FILE")]
    weights: PathBuf,
    /// An f32 array, N×3×H×W for images or N×3×T×H×W for clips, as .npy.
    #[arg(long, value_name = "FILE")]
    input: PathBuf,
    /// Write the features of the average pool instead of the logits.
    #[arg(long)]
    features: bool,
    /// Threads that share the work.
    #[arg(long, default_value_t = 1)]
    threads: usize,
    /// How often to run; the first run is not counted if there are more.
    #[arg(long, default_value_t = 1)]
    repeat: usize,
    /// Where the scores go, N × classes (or features), f32, as .npy.
    #[arg(long, value_name = "FILE")]
    output: PathBuf,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
#[value(rename_all = "snake_case")]
enum Model {
    Resnet18,
    Resnet34,
    Resnet50,
    Resnet101,
    Resnet152,
    /// SlowOnly with a ResNet-50, mmaction2's.
    SlowonlyMm,
    /// SlowOnly with a ResNet-18, mmaction2's.
    SlowonlyR18Mm,
    /// SlowOnly with a ResNet-50, PyTorchVideo's.
    SlowonlyPtv,
    /// SlowFast with a ResNet-50, PyTorchVideo's.
    SlowfastPtv,
}

/// A loaded network with its input.
enum Inference {
    Images(ResNet, Array4<f32>),
    Clips(SlowOnly, Array5<f32>),
    TwoSpeeds(SlowFast, Array5<f32>),
}

impl Inference {
    fn run(&mut self) -> Result<Scores<'_>, Error> {
        match self {
            Self::Images(network, images) => network.infer(images.view()),
            Self::Clips(network, clips) => network.infer(clips.view()),
            Self::TwoSpeeds(network, clips) => network.infer(clips.view()),
        }
    }

    /// Multiplications and additions for the whole batch.
    fn operations(&self) -> f64 {
        let (batch, operations) = match self {
            Self::Images(network, images) => (images.dim().0, network.operations()),
            Self::Clips(network, clips) => (clips.dim().0, network.operations()),
            Self::TwoSpeeds(network, clips) => (clips.dim().0, network.operations()),
        };
        batch as f64 * operations as f64
    }
}

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    ensure!(arguments.threads > 0, "--threads 0: give at least one");
    ensure!(arguments.repeat > 0, "--repeat 0: give at least one");
    let start = Instant::now();
    let mut inference = load(&arguments)?;
    println!("loaded in {:.3} s", start.elapsed().as_secs_f64());
    let mut times = Vec::with_capacity(arguments.repeat);
    for _ in 0..arguments.repeat {
        let start = Instant::now();
        inference.run()?;
        times.push(start.elapsed().as_secs_f64());
    }
    report(&mut times, inference.operations());
    let scores = inference.run()?;
    let scores: Array2<f32> =
        if arguments.features { scores.features } else { scores.logits }.to_owned();
    write_npy(&arguments.output, &scores)
        .with_context(|| format!("cannot write {}", arguments.output.display()))
}

fn load(arguments: &Arguments) -> Result<Inference> {
    let options = Options { threads: arguments.threads, ..Options::default() };
    let input = read_input(&arguments.input)?;
    let weights = Checkpoint::open(&arguments.weights)?;
    let slow_only = match arguments.model {
        Model::Resnet18 => return images(ResNetDepth::Eighteen, weights, input, options),
        Model::Resnet34 => return images(ResNetDepth::ThirtyFour, weights, input, options),
        Model::Resnet50 => return images(ResNetDepth::Fifty, weights, input, options),
        Model::Resnet101 => return images(ResNetDepth::OneHundredOne, weights, input, options),
        Model::Resnet152 => {
            return images(ResNetDepth::OneHundredFiftyTwo, weights, input, options);
        }
        Model::SlowonlyMm => Some(SlowOnlyForm::MmAction2),
        Model::SlowonlyR18Mm => Some(SlowOnlyForm::MmAction2Depth18),
        Model::SlowonlyPtv => Some(SlowOnlyForm::PyTorchVideo),
        Model::SlowfastPtv => None,
    };
    let shape = input.shape().to_vec();
    let clips = input
        .into_dimensionality::<Ix5>()
        .with_context(|| format!("clips are N x 3 x T x H x W, not {shape:?}"))?;
    let (_, _, frames, height, width) = clips.dim();
    Ok(if let Some(form) = slow_only {
        Inference::Clips(SlowOnly::load(form, weights, [frames, height, width], options)?, clips)
    } else {
        Inference::TwoSpeeds(SlowFast::load(weights, [height, width], options)?, clips)
    })
}

fn images(
    depth: ResNetDepth,
    weights: Checkpoint,
    input: ArrayD<f32>,
    options: Options,
) -> Result<Inference> {
    let shape = input.shape().to_vec();
    let images = input
        .into_dimensionality::<Ix4>()
        .with_context(|| format!("images are N x 3 x H x W, not {shape:?}"))?;
    let (_, _, height, width) = images.dim();
    Ok(Inference::Images(ResNet::load(depth, weights, [height, width], options)?, images))
}

fn read_input(path: &Path) -> Result<ArrayD<f32>> {
    read_npy(path).with_context(|| format!("cannot read {} as an f32 array", path.display()))
}

fn report(times: &mut [f64], operations: f64) {
    let counted = if times.len() > 1 { &mut times[1..] } else { times };
    counted.sort_by(f64::total_cmp);
    let (low, high) = (counted[(counted.len() - 1) / 2], counted[counted.len() / 2]);
    let median = 0.5 * (low + high);
    println!(
        "median {:.3} ms, minimum {:.3} ms, {:.1} GFLOP/s",
        1e3 * median,
        1e3 * counted[0],
        1e-9 * operations / median
    );
}
