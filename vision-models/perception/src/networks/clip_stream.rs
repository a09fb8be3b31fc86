//! A network for clips on the newest frames of a camera.

use ndarray::{Array4, Axis};
use vision_models::{LinearHead, Preprocessing, SlowOnly, SlowOnlyForm, SlowOnlyStream};

use super::clip_classifier::probabilities;
use crate::{error::Error, frames::Picture};

/// Returns the preprocessing of the library from which a SlowOnly comes.
pub(crate) fn preprocessing_of(form: SlowOnlyForm) -> Preprocessing {
    match form {
        SlowOnlyForm::PyTorchVideo => Preprocessing::PYTORCHVIDEO,
        SlowOnlyForm::MmAction2
        | SlowOnlyForm::MmAction2Depth18
        | SlowOnlyForm::MmAction2Depth101 => Preprocessing::MMACTION2,
    }
}

/// SlowOnly over a sliding window of frames, each an image.
#[derive(Debug)]
pub struct ClipStream {
    stream: SlowOnlyStream,
    preprocessing: Preprocessing,
    /// The head that replaces the network's own last layer.
    head: Option<LinearHead>,
}

impl ClipStream {
    /// Creates a stream with an empty window of `length` frames. The centre crop of each frame is
    /// used.
    ///
    /// # Errors
    /// Those of [`SlowOnlyStream::new`].
    pub fn new(
        network: SlowOnly,
        length: usize,
        preprocessing: Preprocessing,
        head: Option<LinearHead>,
    ) -> Result<Self, Error> {
        let size = [length, preprocessing.crop, preprocessing.crop];
        Ok(Self { stream: SlowOnlyStream::new(network, size)?, preprocessing, head })
    }

    /// Adds a frame to the window. Returns the probability of each class if the window is full.
    ///
    /// # Errors
    /// Names an image that cannot be used.
    pub fn push(&mut self, image: &Picture) -> Result<Option<Vec<f32>>, Error> {
        let image = self.prepared(image)?;
        let Some(scores) = self.stream.push(image.index_axis(Axis(0), 0))? else { return Ok(None) };
        probabilities(self.head.as_ref(), &scores, 0).map(Some)
    }

    /// Adds a frame to the window without evaluating it, which takes less time.
    ///
    /// # Errors
    /// Names an image that cannot be used.
    pub fn add(&mut self, image: &Picture) -> Result<(), Error> {
        let image = self.prepared(image)?;
        Ok(self.stream.add(image.index_axis(Axis(0), 0))?)
    }

    fn prepared(&self, image: &Picture) -> Result<Array4<f32>, Error> {
        let pixels = image.read()?;
        self.preprocessing.image(pixels.view()).map_err(Error::content(image.name()))
    }

    /// Forgets all frames.
    pub fn clear(&mut self) {
        self.stream.clear();
    }
}
