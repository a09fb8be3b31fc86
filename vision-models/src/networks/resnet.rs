//! Residual networks for images.

use ndarray::ArrayView4;

use crate::engine::{Network, Options, Scores, Threads};
use crate::error::Error;
use crate::weights::TensorSource;

use super::architecture::ResNetForm;
use super::clips::from_images;
use super::kind::NetworkKind;

/// A residual network in torchvision's form (ResNet, ResNeXt, Wide ResNet): features at the average pool, and
/// class scores.
#[derive(Debug)]
pub struct ResNet(Network);

impl ResNet {
    /// The names and shapes of the tensors that a checkpoint with this many classes must hold.
    pub fn parameters(form: impl Into<ResNetForm>, classes: usize) -> Vec<(String, Vec<usize>)> {
        NetworkKind::ResNet(form.into()).parameters(classes)
    }

    /// Takes the weights of a torchvision checkpoint and packs them for images of
    /// `height` × `width` (other sizes run too, less fast). The linear layer is `fc` or `fc.1`, or there is
    /// none: then there are features alone.
    ///
    /// # Errors
    /// [`Error::Weights`] with every tensor that is missing, surplus or misshapen; [`Error::Value`]
    /// for one that is not finite and for negative variances, [`Error::Overflow`];
    /// [`Error::Size`] if the images are; [`Error::Threads`] for a
    /// number of threads that cannot be started.
    pub fn load(
        form: impl Into<ResNetForm>,
        tensors: impl TensorSource,
        [height, width]: [usize; 2],
        options: Options,
    ) -> Result<Self, Error> {
        let kind = NetworkKind::ResNet(form.into());
        kind.load(Box::new(tensors), [1, height, width], options).map(Self)
    }

    /// Plans for images of another size and keeps the plan.
    ///
    /// # Errors
    /// As of [`Network::plan`].
    pub fn plan(&mut self, [height, width]: [usize; 2]) -> Result<(), Error> {
        self.0.plan([1, height, width])
    }

    /// Runs on other threads from now on, which networks may share.
    ///
    /// # Errors
    /// As of [`Network::share_threads`].
    pub fn share_threads(&mut self, threads: &Threads) -> Result<(), Error> {
        self.0.share_threads(threads)
    }

    /// The scores of normalised images, N × 3 × height × width.
    ///
    /// # Errors
    /// [`Error::Size`] if there are not three channels or no images, or for a size that does not fit,
    /// [`Error::Value`] if a value is NaN or infinite, [`Error::Overflow`] if activations are.
    pub fn infer(&mut self, images: ArrayView4<'_, f32>) -> Result<Scores<'_>, Error> {
        Ok(self.0.infer(from_images(images))?.scores())
    }

    /// Multiplications and additions for one image of the size that the network was loaded for.
    pub fn operations(&self) -> u64 {
        self.0.operations()
    }

    /// How many classes there are: the width of the logits. 0 for a checkpoint without a head.
    pub fn classes(&self) -> usize {
        self.0.classes()
    }

    /// How many features the last layer sees: the width of the features.
    pub fn features(&self) -> usize {
        self.0.features()
    }
}
