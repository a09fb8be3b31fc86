//! Runs a network on arrays, and says how long it takes.

use std::{io::Write, path::PathBuf, process::ExitCode, time::Instant};

use anyhow::{Context, Result, bail};
use clap::Parser;
use examples::program::{
    self, Ending, Json, OutputFile, Program, ProgramError, Quiet, Session, Threads,
};
use examples::vision::choices::{self, with_option};
use human_perception::{Error as PerceptionError, Watch, networks::open_weights, npy::read_array};
use ndarray::{Array, Array4, Array5, ArrayD, ArrayViewD, Dimension};
use ndarray_npy::WriteNpyExt;
use serde::Serialize;
use vision_models::{
    Error, NetworkKind, Options, Passes, ResNet, Scores, SimpleBaseline, SlowFast, SlowOnly,
};

/// Runs a network on an array of normalised images or clips.
///
/// Writes its scores, and prints the median and the minimum time of an inference (of the whole
/// batch) and the rate that the median means, counting the multiplications and additions of the
/// plain convolutions. Ctrl-C ends the repetitions early; the scores are written if there are any.
#[derive(Debug, Parser)]
#[command(version)]
struct Arguments {
    /// The network.
    #[arg(long, value_parser = choices::network())]
    model: NetworkKind,
    /// The checkpoint: safetensors, or PyTorch's .pth, .pt, .pyth. It says how many classes.
    #[arg(long, value_name = "FILE")]
    weights: PathBuf,
    /// An f32 array, N×3×H×W for images or N×3×T×H×W for clips, as .npy.
    #[arg(long, value_name = "FILE")]
    input: PathBuf,
    /// Write the features of the average pool instead of the logits.
    #[arg(long)]
    features: bool,
    /// How often to run; the first run is not counted if there are more.
    #[arg(long, value_name = "COUNT", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    repeat: u32,
    /// Where the scores go, N × classes (or features, or joints × rows × columns), f32, as .npy.
    #[arg(long, short, value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    threads: Threads,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    quiet: Quiet,
}

/// A loaded network with its input.
enum Inference {
    Images(ResNet, Array4<f32>),
    Clips(SlowOnly, Array5<f32>),
    TwoSpeeds(SlowFast, Array5<f32>),
    Joints(Box<SimpleBaseline>, Array4<f32>),
}

impl Inference {
    /// Logits, features or maps.
    fn run(&mut self, features: bool) -> Result<ArrayViewD<'_, f32>, Error> {
        let Scores { logits, features: pooled } = match self {
            Self::Images(network, images) => network.infer(images.view())?,
            Self::Clips(network, clips) => network.infer(clips.view())?,
            Self::TwoSpeeds(network, clips) => network.infer(clips.view())?,
            Self::Joints(network, images) => {
                return Ok(network.heatmaps(images.view())?.into_dyn());
            }
        };
        Ok(if features { pooled } else { logits }.into_dyn())
    }

    /// Multiplications and additions for the whole batch.
    fn operations(&self) -> f64 {
        let (batch, operations) = match self {
            Self::Images(network, images) => (images.dim().0, network.operations()),
            Self::Clips(network, clips) => (clips.dim().0, network.operations()),
            Self::TwoSpeeds(network, clips) => (clips.dim().0, network.operations()),
            Self::Joints(network, images) => (images.dim().0, network.operations()),
        };
        batch as f64 * operations as f64
    }
}

/// The line of `--json`.
#[derive(Serialize)]
struct Timed {
    network: String,
    output: PathBuf,
    /// Inputs, and classes or features; of a pose network joints, rows and columns.
    shape: Vec<usize>,
    load_s: f64,
    #[serde(flatten)]
    times: Times,
    gflop_per_s: f64,
}

impl Program for Arguments {
    fn quiet(&self) -> Quiet {
        self.quiet
    }

    fn run(self, session: &mut Session) -> Result<Ending> {
        let mut file = OutputFile::create(&self.output)?;
        let start = Instant::now();
        let mut inference = self.load(&mut session.watch())?;
        let load_s = start.elapsed().as_secs_f64();
        writeln!(session.output(), "loaded in {load_s:.3} s")?;
        let operations = inference.operations();

        let progress = session.progress("runs", u64::from(self.repeat));
        let repeat = self.repeat as usize;
        let mut times = Vec::new();
        let mut result = ArrayD::default(vec![0]);
        while times.len() < repeat {
            if session.interrupt().requested() {
                break;
            }
            let start = Instant::now();
            let scores = inference.run(self.features)?;
            times.push(start.elapsed().as_secs_f64());
            result = scores.as_standard_layout().into_owned();
            progress.set(times.len() as u64);
        }
        progress.finish();
        if times.is_empty() {
            return Err(ProgramError::Interrupted.into());
        }
        // The scores of each run are the same: they are whole after the first.
        result
            .write_npy(&mut file)
            .with_context(|| format!("cannot write {}", self.output.display()))?;
        file.keep()?;
        let ending = if times.len() < repeat { Ending::Partial } else { Ending::Complete };
        if ending == Ending::Partial {
            session.warn(format_args!("interrupted after {} of {repeat} runs", times.len()));
        }
        let times = Times::of(&mut times);
        let Times { median_s, minimum_s, .. } = times;
        let gflop_per_s = 1e-9 * operations / median_s;
        writeln!(
            session.output(),
            "median {:.3} ms, minimum {:.3} ms, {gflop_per_s:.1} GFLOP/s",
            1e3 * median_s,
            1e3 * minimum_s
        )?;
        let shape = result.shape().to_vec();
        let network = self.model.to_string();
        let timed = Timed { network, output: self.output, shape, load_s, times, gflop_per_s };
        session.conclude(self.json, &timed, ending)
    }
}

/// The times of the runs, without the first if there are more.
#[derive(Clone, Copy, Serialize)]
struct Times {
    /// Runs that were counted.
    runs: usize,
    median_s: f64,
    minimum_s: f64,
}

impl Times {
    fn of(times: &mut [f64]) -> Self {
        let counted = if times.len() > 1 { &mut times[1..] } else { times };
        counted.sort_by(f64::total_cmp);
        let runs = counted.len();
        let median_s = 0.5 * (counted[(runs - 1) / 2] + counted[runs / 2]);
        Self { runs, median_s, minimum_s: counted[0] }
    }
}

impl Arguments {
    fn load(&self, watch: &mut Watch<'_>) -> Result<Inference> {
        let options = Options { threads: self.threads.count(), ..Options::default() };
        let input = read_array(&self.input)?;
        let weights = open_weights(&self.weights, watch)?;
        let of_weights = |error| with_option(PerceptionError::weights(&self.weights)(error), "");
        if let NetworkKind::ResNet(form) = self.model {
            let images: Array4<f32> = self.of_dimension(input, "images are N × 3 × H × W")?;
            let (_, _, height, width) = images.dim();
            let network = ResNet::load(form, weights, [height, width], options);
            return Ok(Inference::Images(network.map_err(of_weights)?, images));
        }
        if let NetworkKind::SimpleBaseline(_) = self.model {
            let images: Array4<f32> = self.of_dimension(input, "images are N × 3 × H × W")?;
            let network =
                SimpleBaseline::load(weights, Passes::One, options).map_err(of_weights)?;
            return Ok(Inference::Joints(Box::new(network), images));
        }
        let clips: Array5<f32> = self.of_dimension(input, "clips are N × 3 × T × H × W")?;
        let (_, _, frames, height, width) = clips.dim();
        if let NetworkKind::SlowOnly(form) = self.model {
            let network = SlowOnly::load(form, weights, [frames, height, width], options);
            return Ok(Inference::Clips(network.map_err(of_weights)?, clips));
        }
        let NetworkKind::SlowFast(form) = self.model else {
            bail!("{} does not run on one array", self.model)
        };
        let network = SlowFast::load(form, weights, [frames, height, width], options);
        Ok(Inference::TwoSpeeds(network.map_err(of_weights)?, clips))
    }

    /// The input with the number of axes that the network takes.
    fn of_dimension<D: Dimension>(
        &self,
        input: ArrayD<f32>,
        expected: &str,
    ) -> Result<Array<f32, D>> {
        let shape = input.shape().to_vec();
        input.into_dimensionality().ok().with_context(|| {
            format!("{}: an array of shape {shape:?}, but {expected}", self.input.display())
        })
    }
}

fn main() -> ExitCode {
    program::main::<Arguments>()
}
