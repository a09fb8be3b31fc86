//! The network of the options.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use human_perception::{
    actions::model::ActionModel,
    networks::{names, open_checkpoint},
    surface::model::SurfaceModel,
};
use vision_models::{ClassNames, NetworkKind, ResNetDepth, TensorFlowLite};

use crate::program::Threads;

/// The network and its classes.
#[derive(Args, Debug)]
pub struct NetworkOptions {
    /// The network's name, such as resnet50 or slowonly_mm, or the folder of a model that `surface train` or `actions
    /// train` has made. If it is left out, the checkpoint identifies the network.
    #[arg(long, value_name = "NAME or FOLDER", value_parser = model)]
    model: Option<Model>,
    /// The checkpoint: safetensors, PyTorch's .pth, .pt, .pyth, or a network of TensorFlow Lite, .tflite. A model over
    /// several networks takes one for each, behind its number of layers, such as 50=resnet50.pth. Networks with random
    /// weights take none.
    #[arg(long, value_name = "FILE", value_parser = weights)]
    weights: Vec<(Option<ResNetDepth>, PathBuf)>,
    /// The names of the network's classes, one a line. Default for a SlowOnly with thirty classes: HRI30's.
    #[arg(long, value_name = "FILE")]
    names: Option<PathBuf>,
    /// Threads that share the work.
    #[command(flatten)]
    pub threads: Threads,
}

#[derive(Clone, Debug)]
enum Model {
    Network(NetworkKind),
    Folder(PathBuf),
}

/// The selection by `--model` and `--weights`.
#[derive(Debug)]
pub enum Chosen {
    /// A network with its own last layer.
    Network(NetworkKind, PathBuf),
    /// A network of TensorFlow Lite.
    File(PathBuf),
    /// A model of `surface train`.
    Surfaces(SurfaceModel, Vec<(Option<ResNetDepth>, PathBuf)>),
    /// A model of `actions train`.
    Actions(Box<ActionModel>, Option<PathBuf>),
}

/// Parses a network's name or a folder.
fn model(text: &str) -> Result<Model, String> {
    let named = names::networks().into_iter().find(|(name, _)| *name == text);
    match named {
        Some((_, kind)) => Ok(Model::Network(kind)),
        None if Path::new(text).is_dir() => Ok(Model::Folder(text.into())),
        None => {
            let names: Vec<_> = names::networks().into_iter().map(|(name, _)| name).collect();
            Err(format!("no folder, and no network: give one of {}", names.join(", ")))
        }
    }
}

/// Parses FILE or DEPTH=FILE.
#[expect(clippy::unnecessary_wraps, reason = "a parser of the command line")]
fn weights(text: &str) -> Result<(Option<ResNetDepth>, PathBuf), String> {
    let behind_depth =
        text.split_once('=').and_then(|(depth, file)| Some((names::depth_of(depth)?, file)));
    Ok(match behind_depth {
        Some((depth, file)) => (Some(depth), file.into()),
        None => (None, text.into()),
    })
}

impl NetworkOptions {
    /// The names of the classes, with their file.
    ///
    /// # Errors
    /// The file that cannot be used.
    pub fn names(&self) -> Result<Option<(&Path, ClassNames)>> {
        let Some(file) = self.names.as_deref() else { return Ok(None) };
        Ok(Some((file, ClassNames::read(file).with_context(|| file.display().to_string())?)))
    }

    /// The network, of which only the description is read.
    ///
    /// # Errors
    /// The file or the option that is wrong or missing.
    pub fn chosen(&self) -> Result<Chosen> {
        let file = || self.weights.first().map(|(_, file)| file.clone());
        match &self.model {
            Some(Model::Folder(folder)) => {
                ensure!(self.names.is_none(), "--names: a trained model has names of its own");
                if SurfaceModel::is_in(folder) {
                    return Ok(Chosen::Surfaces(SurfaceModel::read(folder)?, self.weights.clone()));
                }
                ensure!(
                    ActionModel::is_in(folder),
                    "{}: no model: there is neither surface.json nor actions.json in it",
                    folder.display()
                );
                Ok(Chosen::Actions(Box::new(ActionModel::read(folder)?), file()))
            }
            Some(Model::Network(kind)) => {
                let Some(file) = file() else {
                    bail!("give the network's weights: --weights FILE")
                };
                Ok(Chosen::Network(*kind, file))
            }
            None => {
                let Some(file) = file() else { bail!("no network: give --weights or --model") };
                if TensorFlowLite::is_in(&file) {
                    return Ok(Chosen::File(file));
                }
                let found = NetworkKind::of(&open_checkpoint(&file)?);
                let shown = file.display();
                let kind = found
                    .with_context(|| format!("{shown}: no network that is known: give --model"))?;
                Ok(Chosen::Network(kind, file))
            }
        }
    }
}
