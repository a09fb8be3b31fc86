//! Runs a network on images, folders of frames and arrays.

use std::{path::PathBuf, process::ExitCode};

use anyhow::{Result, bail, ensure};
use clap::Parser;
use examples::infer::{
    Results,
    arrays::ArrayOptions,
    clips::ClipOptions,
    images::ImageOptions,
    network::{Chosen, NetworkOptions},
};
use examples::program::{self, Ending, Printing, Program, ResultFile, Session};
use examples::vision::choices::with_option;
use human_perception::networks::Input;
use vision_models::NetworkKind;

/// Runs a network on images, on a folder of frames, or on an array.
///
/// Prints the five most probable classes of each image, or the results of a trained model. A folder of frames gives the
/// five most probable actions, as the mean over all clips and crops.
///
/// The scores of an array are written with --output. Its median and minimum time of an inference (of the whole batch)
/// are printed, and the rate at the median time. The rate counts the multiplications and additions of the plain
/// convolutions.
///
/// An image that cannot be read is named on standard error and left out; the exit status is then 1. Ctrl-C ends early
/// and keeps the results so far.
#[derive(Debug, Parser)]
#[command(version)]
struct Arguments {
    /// JPEG or PNG files; one folder of them, one a frame, in the order of their names; or one f32 array as .npy, with
    /// normalised images, N×3×H×W, or clips, N×3×T×H×W.
    #[arg(required = true)]
    inputs: Vec<PathBuf>,
    #[command(flatten)]
    network: NetworkOptions,
    #[command(flatten)]
    result: ResultFile,
    #[command(flatten)]
    printing: Printing,
    #[command(flatten)]
    images: ImageOptions,
    #[command(flatten)]
    clips: ClipOptions,
    #[command(flatten)]
    arrays: ArrayOptions,
}

impl Program for Arguments {
    fn run(self, session: &mut Session) -> Result<Ending> {
        let Self { inputs, network, images, clips, arrays, .. } = self;
        let results = Results::begin(&self.result, self.printing)?;
        let names = network.names()?;
        let kinds: Vec<Input> =
            inputs.iter().map(|path| Input::of(path)).collect::<Result<_, _>>()?;
        let (Some(&kind), Some(first)) = (kinds.first(), inputs.first()) else {
            bail!("give images, a folder of frames or an array");
        };
        ensure!(
            kinds.len() == 1 || kinds.iter().all(|kind| *kind == Input::Image),
            "give images, or one folder of frames, or one array"
        );
        let threads = network.threads.count();
        let watch = &mut session.watch();
        match (network.chosen()?, kind) {
            (Chosen::Network(kind, weights), Input::Array) => {
                arrays.run((Some(kind), &weights), first, threads, session, results)
            }
            (Chosen::File(weights), Input::Array) => {
                arrays.run((None, &weights), first, threads, session, results)
            }
            (Chosen::Network(NetworkKind::ResNet(form), weights), Input::Image) => {
                let network = images.own(form, &weights, names, (threads, watch))?;
                images.run(network, inputs, session, results)
            }
            (Chosen::Surfaces(model, weights), Input::Image) => {
                let network = images.model(model, &weights, (threads, watch))?;
                images.run(network, inputs, session, results)
            }
            (Chosen::Network(NetworkKind::SlowOnly(form), weights), Input::Clip) => {
                clips.run(clips.own(form, weights, names), first, threads, session, results)
            }
            (Chosen::Actions(model, weights), Input::Clip) => {
                let weights = model.weights.weights(weights, watch);
                let weights = weights.map_err(|error| with_option(error, "--weights FILE"))?;
                clips.run(clips.model(*model, weights)?, first, threads, session, results)
            }
            (Chosen::Network(kind, _), _) => bail!("{}: {}", first.display(), wanted(kind)),
            (Chosen::File(_), _) => {
                bail!("{}: a network of TensorFlow Lite takes an array", first.display())
            }
            (Chosen::Surfaces(..), _) => {
                bail!("{}: a model of surfaces takes JPEG or PNG files", first.display())
            }
            (Chosen::Actions(..), _) => {
                bail!("{}: a model of actions takes a folder of JPEG or PNG files", first.display())
            }
        }
    }
}

/// The inputs for a network with its own last layer.
fn wanted(kind: NetworkKind) -> String {
    let files = match kind {
        NetworkKind::ResNet(_) => "JPEG or PNG files, or an array",
        NetworkKind::SlowOnly(_) => "a folder of JPEG or PNG files, or an array",
        _ => "an array",
    };
    format!("a {kind} takes {files}")
}

fn main() -> ExitCode {
    program::main::<Arguments>()
}
