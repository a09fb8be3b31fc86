//! SlowOnly: the slow path of SlowFast alone.

use ndarray::ArrayView5;

use crate::{Error, TensorSource};

use super::backbone::{Backbone, ResNetDepth};
use super::graph::{Architecture, Graph};
use super::head::Pooling;
use super::kind::NetworkKind;
use super::naming::Naming;
use super::network::{Clips, Network, Options, Scores};

/// Which SlowOnly a checkpoint holds. The backbones differ in depth and names, the heads in what
/// they pool.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlowOnlyForm {
    /// mmaction2's with a ResNet-50; the mean over all frames and positions.
    MmAction2,
    /// mmaction2's with a ResNet-18.
    MmAction2Depth18,
    /// PyTorchVideo's `slow_r50`; the mean of the windows of 8 × 7 × 7, which differs from
    /// mmaction2's unless the clip has 8 frames of 224 × 224.
    PyTorchVideo,
}

/// SlowOnly: class scores of a clip. C. Feichtenhofer, H. Fan, J. Malik and K. He, "SlowFast
/// networks for video recognition", ICCV 2019, Table 1, the slow pathway.
#[derive(Debug)]
pub struct SlowOnly(pub(super) Network);

impl SlowOnly {
    /// The names and shapes of the tensors that a checkpoint with this many classes must hold.
    pub fn parameters(form: SlowOnlyForm, classes: usize) -> Vec<(String, Vec<usize>)> {
        architecture(form).expected(classes).into_tensors()
    }

    /// Takes the weights of a checkpoint and packs them for clips of `frames` × `height` × `width`
    /// (other sizes run too, less fast). The checkpoint says how many classes there are.
    ///
    /// # Errors
    /// [`Error::Weights`] with every tensor that is missing, surplus or misshapen; [`Error::Weight`]
    /// for one that is not finite and for negative variances, [`Error::FoldedWeights`];
    /// [`Error::InputTooSmall`] if the frames are too small; [`Error::Threads`] for a number of
    /// threads that cannot be started.
    pub fn load(
        form: SlowOnlyForm,
        tensors: impl TensorSource,
        size: [usize; 3],
        options: Options,
    ) -> Result<Self, Error> {
        Network::load(NetworkKind::SlowOnly(form), Box::new(tensors), size, options).map(Self)
    }

    /// The scores of normalised clips, N × 3 × frames × height × width.
    ///
    /// # Errors
    /// [`Error::InputShape`] if there are not three channels or no clips;
    /// [`Error::InputTooSmall`] if a kernel does not fit, [`Error::PoolTooSmall`] if the head's
    /// windows do not; [`Error::NotFinite`] if a value is NaN or infinite, [`Error::Overflow`] if
    /// activations are.
    pub fn infer(&mut self, clips: ArrayView5<'_, f32>) -> Result<Scores<'_>, Error> {
        self.0.infer(&Clips::new(clips))
    }

    /// Multiplications and additions for one clip of the size that the network was loaded for.
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

pub(super) fn architecture(form: SlowOnlyForm) -> Architecture {
    let (depth, naming, classifier, pooling) = match form {
        SlowOnlyForm::MmAction2 => {
            (ResNetDepth::Fifty, Naming::MmAction2, "cls_head.fc_cls", Pooling::Mean)
        }
        SlowOnlyForm::MmAction2Depth18 => {
            (ResNetDepth::Eighteen, Naming::MmAction2, "cls_head.fc_cls", Pooling::Mean)
        }
        SlowOnlyForm::PyTorchVideo => {
            let windows = Pooling::Windows([8, 7, 7]);
            (ResNetDepth::Fifty, Naming::PyTorchVideo, "blocks.5.proj", windows)
        }
    };
    let backbone = Backbone { depth, naming, width: 64, stem_frames: 1, frames: [1, 1, 3, 3] };
    let mut graph = Graph::default();
    let clip = graph.value(3);
    let mut x = backbone.stem(&mut graph, clip, 0);
    for stage in 1..=4 {
        x = backbone.stage(&mut graph, stage, x, 0);
    }
    Architecture { graph, inputs: vec![(clip, 1)], outputs: vec![(x, pooling)], classifier }
}
