//! Residual networks for images.

use ndarray::ArrayView4;

use crate::{Error, TensorSource};

use super::backbone::{Backbone, ResNetDepth};
use super::graph::{Architecture, Graph};
use super::head::Pooling;
use super::kind::NetworkKind;
use super::naming::Naming;
use super::network::{Clips, Network, Options, Scores};

/// A residual network in torchvision's form: features at the average pool, and class scores.
#[derive(Debug)]
pub struct ResNet(Network);

impl ResNet {
    /// The names and shapes of the tensors that a checkpoint with this many classes must hold.
    pub fn parameters(depth: ResNetDepth, classes: usize) -> Vec<(String, Vec<usize>)> {
        architecture(depth).expected(classes).into_tensors()
    }

    /// Takes the weights of a torchvision checkpoint and packs them for images of
    /// `height` × `width` (other sizes run too, less fast).
    ///
    /// # Errors
    /// [`Error::Weights`] with every tensor that is missing, surplus or misshapen; [`Error::Weight`]
    /// for one that is not finite and for negative variances, [`Error::FoldedWeights`];
    /// [`Error::InputTooSmall`] if the images are too small; [`Error::Threads`] for a number of
    /// threads that cannot be started.
    pub fn load(
        depth: ResNetDepth,
        tensors: impl TensorSource,
        [height, width]: [usize; 2],
        options: Options,
    ) -> Result<Self, Error> {
        Network::load(NetworkKind::ResNet(depth), Box::new(tensors), [1, height, width], options)
            .map(Self)
    }

    /// The scores of normalised images, N × 3 × height × width.
    ///
    /// # Errors
    /// [`Error::InputShape`] if there are not three channels or no images,
    /// [`Error::InputTooSmall`] if a kernel does not fit, [`Error::NotFinite`] if a value is NaN
    /// or infinite, [`Error::Overflow`] if activations are.
    pub fn infer(&mut self, images: ArrayView4<'_, f32>) -> Result<Scores<'_>, Error> {
        self.0.infer(&Clips::from_images(images))
    }

    /// Multiplications and additions for one image of the size that the network was loaded for.
    pub fn operations(&self) -> u64 {
        self.0.operations()
    }

    /// How many classes there are: the width of the logits.
    pub fn classes(&self) -> usize {
        self.0.classes()
    }

    /// How many features the last layer sees: the width of the features.
    pub fn features(&self) -> usize {
        self.0.features()
    }
}

pub(super) fn architecture(depth: ResNetDepth) -> Architecture {
    let backbone =
        Backbone { depth, naming: Naming::Torchvision, width: 64, stem_frames: 1, frames: [1; 4] };
    let mut graph = Graph::default();
    let image = graph.value(3);
    let mut x = backbone.stem(&mut graph, image, 0);
    for stage in 1..=4 {
        x = backbone.stage(&mut graph, stage, x, 0);
    }
    Architecture {
        graph,
        inputs: vec![(image, 1)],
        outputs: vec![(x, Pooling::Mean)],
        classifier: "fc",
    }
}
