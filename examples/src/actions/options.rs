//! Options that several commands share.

use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::Args;
use human_perception::{actions::window::Window, learning::backbone::Weights};

use crate::vision::choices;

/// The SlowOnly network, and the size of its window.
#[derive(Args, Clone, Debug)]
pub struct NetworkOptions {
    /// The SlowOnly's checkpoint.
    #[arg(long, value_name = "FILE")]
    weights: Option<PathBuf>,
    /// Take a network with random weights of this seed instead, which has learnt nothing.
    #[arg(long, value_name = "SEED", conflicts_with = "weights")]
    random_backbone: Option<u64>,
    /// The form of the SlowOnly.
    #[arg(long, default_value = "slowonly_mm", value_parser = choices::slow_only_name())]
    network: String,
    /// Frames of a window, 1 to 64.
    #[arg(long, default_value_t = 8, value_parser = clap::value_parser!(u16).range(1..=64))]
    length: u16,
    /// Frames of the video between two of a window, 1 to 64.
    #[arg(long, default_value_t = 4, value_parser = clap::value_parser!(u16).range(1..=64))]
    interval: u16,
    /// Short side of the frames (pixels), 32 to 512.
    #[arg(long, default_value_t = 256, value_parser = clap::value_parser!(u16).range(32..=512))]
    side: u16,
}

impl NetworkOptions {
    /// The weights and the window.
    ///
    /// # Errors
    /// If neither a checkpoint nor a seed is given.
    pub fn chosen(&self) -> Result<(Weights, Window)> {
        let weights = match (&self.weights, self.random_backbone) {
            (Some(file), _) => Weights::File(file.clone()),
            (None, Some(seed)) => Weights::Random(seed),
            (None, None) => bail!("no network: give --weights FILE, or --random-backbone SEED"),
        };
        let window = Window {
            network: self.network.clone(),
            length: self.length.into(),
            interval: self.interval.into(),
            side: self.side.into(),
        };
        Ok((weights, window))
    }
}

/// The checkpoint that a model was trained with.
#[derive(Args, Clone, Debug)]
pub struct ModelWeights {
    /// The SlowOnly's checkpoint that the model was trained with; not needed for random weights.
    #[arg(long, value_name = "FILE")]
    pub weights: Option<PathBuf>,
}

impl ModelWeights {
    /// The name of the option, for messages.
    pub const OPTION: &str = "--weights FILE";
}
