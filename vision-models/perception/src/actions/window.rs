//! The network and its input from a clip.

use serde::{Deserialize, Serialize};
use vision_models::{ClipSampling, Crops, Preprocessing, Resize, SlowOnlyForm};

use crate::{
    error::Error,
    learning::backbone::{ClipBackbone, Weights},
    networks::{clip_stream::preprocessing_of, names},
};

/// The window of a network, as stored in a trained model.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Window {
    /// The variant of SlowOnly, by its name on the command line.
    pub network: String,
    /// Number of frames.
    pub length: usize,
    /// Distance in the video from one frame to the next.
    pub interval: usize,
    /// Short side of the frames (pixels).
    pub side: usize,
}

/// The views of a clip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Views {
    /// Number of windows along the clip.
    pub clips: usize,
    /// The crops of each frame.
    pub crops: Crops,
}

impl Views {
    /// One window in the middle, for training.
    pub const MIDDLE: Self = Self { clips: 1, crops: Crops::Centre };
}

impl Window {
    /// Returns the form with this name.
    ///
    /// # Errors
    /// An error if there is none.
    pub fn form(&self) -> Result<SlowOnlyForm, Error> {
        let place = || format!("there is no network \"{}\"", self.network);
        let names = || names::forms().map(|(name, _)| name).join(", ");
        names::form_of(&self.network)
            .ok_or_else(|| Error::at(place(), format_args!("give {}", names())))
    }

    /// Returns the network, which is loaded when it is first used.
    ///
    /// # Errors
    /// Those of [`Self::form`].
    pub fn backbone(&self, weights: Weights, threads: usize) -> Result<ClipBackbone, Error> {
        let size = [self.length, self.side, self.side];
        Ok(ClipBackbone::new(weights, self.form()?, size, threads))
    }

    /// Returns how frames are resized, cropped and normalised.
    ///
    /// # Errors
    /// Those of [`Self::form`].
    pub fn preprocessing(&self, crops: Crops) -> Result<Preprocessing, Error> {
        let library = preprocessing_of(self.form()?);
        let side = self.side;
        Ok(Preprocessing { crops, crop: side, resize: Resize::ShortSide(side), ..library })
    }

    /// Returns the sampling of the windows: in the middle of equal parts, as in mmaction2 before
    /// 1.0.
    pub fn sampling(&self, clips: usize) -> ClipSampling {
        let Self { length, interval, .. } = *self;
        ClipSampling::Mmaction2Before1 { length, interval, clips }
    }
}
