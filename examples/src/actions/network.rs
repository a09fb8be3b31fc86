//! The network, and what it sees of a clip.

use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::Args;
use serde::{Deserialize, Serialize};
use vision_models::{ClipSampling, Crops, Preprocessing, Resize, SlowOnlyForm};

use crate::{
    learning::backbone::{ClipBackbone, Weights},
    vision::{choices, clip_stream::preprocessing_of},
};

/// Which SlowOnly, and the size of its window.
#[derive(Args, Clone, Debug)]
pub struct NetworkOptions {
    /// The SlowOnly's checkpoint.
    #[arg(long, value_name = "FILE")]
    weights: Option<PathBuf>,
    /// Take a network with random weights of this seed instead: nothing is learnt in it.
    #[arg(long, value_name = "SEED", conflicts_with = "weights")]
    random_backbone: Option<u64>,
    /// Which SlowOnly.
    #[arg(long, default_value = "slowonly_mm", value_parser = choices::slow_only_name())]
    network: String,
    /// Frames of a window, 1 to 64.
    #[arg(long, default_value_t = 8, value_parser = clap::value_parser!(u16).range(1..=64))]
    length: u16,
    /// Frames of the video from one of a window to the next, 1 to 64.
    #[arg(long, default_value_t = 4, value_parser = clap::value_parser!(u16).range(1..=64))]
    interval: u16,
    /// Short side of the frames (pixels), 32 to 512.
    #[arg(long, default_value_t = 256, value_parser = clap::value_parser!(u16).range(32..=512))]
    side: u16,
}

/// The window of a network: what a trained model keeps of it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Window {
    /// Which SlowOnly, by its name on the command line.
    pub network: String,
    /// Frames.
    pub length: usize,
    /// Frames of the video from one to the next.
    pub interval: usize,
    /// Short side of the frames (pixels).
    pub side: usize,
}

/// The parts of a clip that are seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Views {
    /// Windows along the clip.
    pub clips: usize,
    /// Parts of each frame.
    pub crops: Crops,
}

impl Views {
    /// One window in the middle: for training.
    pub const MIDDLE: Self = Self { clips: 1, crops: Crops::Centre };
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

impl Window {
    /// The form of its name.
    ///
    /// # Errors
    /// If there is none.
    pub fn form(&self) -> Result<SlowOnlyForm> {
        match choices::slow_only_of(&self.network) {
            Some(form) => Ok(form),
            None => bail!("there is no network \"{}\"", self.network),
        }
    }

    /// The network, loaded when it is first asked.
    ///
    /// # Errors
    /// As of [`Self::form`].
    pub fn backbone(&self, weights: Weights, threads: usize) -> Result<ClipBackbone> {
        let size = [self.length, self.side, self.side];
        Ok(ClipBackbone::new(weights, self.form()?, size, threads))
    }

    /// How frames are resized, cropped and normalised.
    ///
    /// # Errors
    /// As of [`Self::form`].
    pub fn preprocessing(&self, crops: Crops) -> Result<Preprocessing> {
        let library = preprocessing_of(self.form()?);
        let side = self.side;
        Ok(Preprocessing { crops, crop: side, resize: Resize::ShortSide(side), ..library })
    }

    /// Which frames each window of a clip has: in the middle of equal parts, as mmaction2 before 1.0.
    pub fn sampling(&self, clips: usize) -> ClipSampling {
        let Self { length, interval, .. } = *self;
        ClipSampling::Mmaction2Before1 { length, interval, clips }
    }
}
