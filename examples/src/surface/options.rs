//! Options that several commands share.

use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::Args;
use vision_models::ResNetDepth;

use human_perception::{learning::backbone::Weights, networks::names};

use crate::vision::choices;

/// The networks that give the features.
#[derive(Args, Clone, Debug)]
pub struct Backbones {
    /// A ResNet's checkpoint with torchvision's names, behind its number of layers: 50=resnet50.pth. May be given
    /// several times.
    #[arg(long, value_name = "DEPTH=FILE", value_parser = weights)]
    weights: Vec<(ResNetDepth, PathBuf)>,
    /// Take networks with random weights of this seed instead, which have learnt nothing.
    #[arg(long, value_name = "SEED", conflicts_with = "weights")]
    random_backbone: Option<u64>,
    /// Number of layers of the random networks. Default 50 and 152.
    #[arg(long, requires = "random_backbone", value_parser = choices::depth())]
    depth: Vec<ResNetDepth>,
}

/// Parses DEPTH=FILE.
fn weights(text: &str) -> Result<(ResNetDepth, PathBuf), String> {
    let wrong = || format!("\"{text}\": give DEPTH=FILE, such as 50=resnet50.pth");
    let (depth, file) = text.split_once('=').ok_or_else(wrong)?;
    let depth = names::depth_of(depth).ok_or_else(wrong)?;
    if file.is_empty() { Err(wrong()) } else { Ok((depth, file.into())) }
}

impl Backbones {
    /// The networks without repetition.
    ///
    /// # Errors
    /// If there are none, or one is given twice.
    pub fn networks(&self) -> Result<Vec<(ResNetDepth, Weights)>> {
        let networks: Vec<_> = match self.random_backbone {
            Some(seed) if self.depth.is_empty() => {
                vec![ResNetDepth::Fifty, ResNetDepth::OneHundredFiftyTwo]
                    .into_iter()
                    .map(|depth| (depth, Weights::Random(seed)))
                    .collect()
            }
            Some(seed) => self.depth.iter().map(|&depth| (depth, Weights::Random(seed))).collect(),
            None => self
                .weights
                .iter()
                .map(|(depth, file)| (*depth, Weights::File(file.clone())))
                .collect(),
        };
        if networks.is_empty() {
            bail!(
                "no network: give --weights 50=FILE and --weights 152=FILE, or --random-backbone SEED"
            );
        }
        for (place, (depth, _)) in networks.iter().enumerate() {
            if networks.iter().take(place).any(|(other, _)| other == depth) {
                bail!("two networks of {} layers: give one of each depth", depth.layers());
            }
        }
        Ok(networks)
    }
}

/// The checkpoints of a trained model's networks.
#[derive(Args, Clone, Debug)]
pub struct ModelWeights {
    /// The checkpoint that the model was trained with, behind the ResNet's number of layers: 50=resnet50.pth. Not
    /// needed for random weights.
    #[arg(long, value_name = "DEPTH=FILE", value_parser = weights)]
    pub weights: Vec<(ResNetDepth, PathBuf)>,
}

impl ModelWeights {
    /// The name of the option, for messages.
    pub const OPTION: &str = "--weights DEPTH=FILE";
}
