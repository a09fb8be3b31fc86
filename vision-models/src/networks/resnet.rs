//! Residual networks for images.

use ndarray::ArrayView4;

use crate::engine::{Network, Options, Scores, Threads};
use crate::error::Error;
use crate::weights::TensorSource;

use super::architecture::ResNetForm;
use super::clips::from_images;
use super::kind::NetworkKind;

/// A residual network in torchvision's form (ResNet, ResNeXt, Wide ResNet). Its outputs are
/// features after the average pool and class scores.
#[derive(Debug)]
pub struct ResNet(Network);

impl ResNet {
    /// Returns the names and shapes of the tensors that a checkpoint with this many classes must
    /// hold.
    pub fn parameters(form: impl Into<ResNetForm>, classes: usize) -> Vec<(String, Vec<usize>)> {
        NetworkKind::ResNet(form.into()).parameters(classes)
    }

    /// Loads a torchvision checkpoint and packs its weights for images of `height` × `width`. Other
    /// sizes run too, but slower. The linear layer is `fc` or `fc.1`. If it is missing, the network
    /// returns features only.
    ///
    /// # Errors
    /// - [`Error::Weights`] with every tensor that is missing, surplus or of the wrong shape.
    /// - [`Error::Value`] if a weight is not finite or a variance is negative.
    /// - [`Error::Overflow`] if a weight is too large for f32.
    /// - [`Error::Size`] if the size of the images does not fit.
    /// - [`Error::Threads`] if this number of threads cannot be started.
    pub fn load(
        form: impl Into<ResNetForm>,
        tensors: impl TensorSource,
        [height, width]: [usize; 2],
        options: Options,
    ) -> Result<Self, Error> {
        let kind = NetworkKind::ResNet(form.into());
        kind.load(Box::new(tensors), [1, height, width], options).map(Self)
    }

    /// Plans the pass for images of another size and keeps the plan.
    ///
    /// # Errors
    /// Those of [`Network::plan`].
    pub fn plan(&mut self, [height, width]: [usize; 2]) -> Result<(), Error> {
        self.0.plan([1, height, width])
    }

    /// Makes the network run on other threads, which networks may share.
    ///
    /// # Errors
    /// Those of [`Network::share_threads`].
    pub fn share_threads(&mut self, threads: &Threads) -> Result<(), Error> {
        self.0.share_threads(threads)
    }

    /// Returns the scores of normalised images, N × 3 × height × width.
    ///
    /// # Errors
    /// - [`Error::Size`] if there are not three channels, there are no images, or the size does not
    ///   fit.
    /// - [`Error::Value`] if a value is NaN or infinite.
    /// - [`Error::Overflow`] if an output is NaN or infinite.
    pub fn infer(&mut self, images: ArrayView4<'_, f32>) -> Result<Scores<'_>, Error> {
        Ok(self.0.infer(from_images(images))?.scores())
    }

    /// Returns the number of multiplications and additions for one image of the size given at
    /// loading.
    pub fn operations(&self) -> u64 {
        self.0.operations()
    }

    /// Returns the number of classes, which is the width of the logits. 0 for a checkpoint without
    /// a head.
    pub fn classes(&self) -> usize {
        self.0.classes()
    }

    /// Returns the width of the features, which the last layer reads.
    pub fn features(&self) -> usize {
        self.0.features()
    }
}
