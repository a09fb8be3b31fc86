//! SlowFast: a slow path that sees few frames, and a thin fast one that sees them all.

use ndarray::ArrayView5;

use crate::engine::{
    Activation, Convolution, Frames, Graph, Network, Options, Pooling, Scores, Threads,
};
use crate::{Error, TensorSource};

use super::backbone::{Backbone, ResNetDepth};
use super::kind::NetworkKind;
use super::naming::{Names, Naming};

/// Frames of a clip of PyTorchVideo's: the windows of the head leave no choice.
const FRAMES: usize = 32;
/// Channels of the slow path to one of the fast path (1/β).
const THINNESS: usize = 8;
/// Channels of a lateral connection to one of the fast path.
const LATERAL: usize = 2;

/// Which SlowFast a checkpoint holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlowFastForm {
    /// PyTorchVideo's `slowfast_r50`: clips of 32 frames, of which the slow path takes eight, spread evenly
    /// from the first to the last.
    PyTorchVideo,
    /// mmaction2's `8x8`: the slow path takes every fourth frame of the clip, the lateral kernels see seven.
    MmAction2EveryFourth(ResNetDepth),
    /// mmaction2's `4x16`: the slow path takes every eighth frame of the clip, the lateral kernels see five.
    MmAction2EveryEighth(ResNetDepth),
}

impl SlowFastForm {
    fn depth(self) -> ResNetDepth {
        match self {
            Self::PyTorchVideo => ResNetDepth::Fifty,
            Self::MmAction2EveryFourth(depth) | Self::MmAction2EveryEighth(depth) => depth,
        }
    }

    /// Frames of the fast path to one of the slow path (α).
    fn slowness(self) -> usize {
        match self {
            Self::PyTorchVideo | Self::MmAction2EveryFourth(_) => 4,
            Self::MmAction2EveryEighth(_) => 8,
        }
    }

    /// Names of the slow and the fast path.
    fn naming(self) -> [Naming; 2] {
        match self {
            Self::PyTorchVideo => [0, 1].map(Naming::PyTorchVideoPathway),
            _ => ["backbone.slow_path.", "backbone.fast_path."].map(Naming::MmAction2),
        }
    }

    /// From the fast path into the slow one, behind a stage, counted from zero for the stem.
    fn lateral(self, stage: usize, inputs: usize) -> Convolution {
        let outputs = LATERAL * inputs;
        let layer = if self == Self::PyTorchVideo {
            let prefix = format!("blocks.{stage}.multipathway_fusion.");
            Names::new(&prefix, "conv_fast_to_slow", "norm")
                .convolution(outputs, [7, 1, 1], Naming::PyTorchVideo.axes())
                .activation(Activation::Relu)
        } else {
            let block = if stage == 0 { "conv1".to_owned() } else { format!("layer{stage}") };
            let name = format!("backbone.slow_path.{block}_lateral.conv");
            let frames = if self.slowness() == 8 { 5 } else { 7 };
            Convolution::clip(name, outputs, [frames, 1, 1])
        };
        layer.stride([self.slowness(), 1, 1])
    }
}

/// SlowFast: class scores of a clip. C. Feichtenhofer, H. Fan, J. Malik and K. He, "SlowFast networks for
/// video recognition", ICCV 2019, Table 1.
#[derive(Debug)]
pub struct SlowFast {
    network: Network,
    form: SlowFastForm,
}

impl SlowFast {
    /// The names and shapes of the tensors that a checkpoint with this many classes must hold.
    pub fn parameters(form: SlowFastForm, classes: usize) -> Vec<(String, Vec<usize>)> {
        NetworkKind::SlowFast(form).parameters(classes)
    }

    /// Takes the weights of a checkpoint and packs them for clips of `frames` × `height` × `width` (other
    /// sizes run too, less fast). PyTorchVideo's have 32 frames, mmaction2's a multiple of four or eight.
    ///
    /// # Errors
    /// [`Error::Weights`] with every tensor that is missing, surplus or misshapen; [`Error::Weight`]
    /// for one that is not finite and for negative variances, [`Error::FoldedWeights`];
    /// [`Error::FrameCount`] for frames that the two paths cannot share; [`Error::InputTooSmall`] and
    /// [`Error::InputTooLarge`] for clips that do not fit, [`Error::PoolTooSmall`] if the head's windows do
    /// not; [`Error::Threads`] for a number of threads that cannot be started.
    pub fn load(
        form: SlowFastForm,
        tensors: impl TensorSource,
        size: [usize; 3],
        options: Options,
    ) -> Result<Self, Error> {
        check_frames(form, size[0])?;
        let network = NetworkKind::SlowFast(form).load(Box::new(tensors), size, options)?;
        Ok(Self { network, form })
    }

    /// Plans for clips of another size and keeps the plan.
    ///
    /// # Errors
    /// [`Error::FrameCount`], and as of [`Network::plan`].
    pub fn plan(&mut self, size: [usize; 3]) -> Result<(), Error> {
        check_frames(self.form, size[0])?;
        self.network.plan(size)
    }

    /// Runs on other threads from now on, which networks may share.
    ///
    /// # Errors
    /// As of [`Network::share_threads`].
    pub fn share_threads(&mut self, threads: &Threads) -> Result<(), Error> {
        self.network.share_threads(threads)
    }

    /// The scores of normalised clips, N × 3 × frames × height × width.
    ///
    /// # Errors
    /// [`Error::InputShape`] if there are not three channels or no clips; [`Error::FrameCount`] for frames
    /// that the two paths cannot share; [`Error::InputTooSmall`] and [`Error::InputTooLarge`] for a size that
    /// does not fit, [`Error::PoolTooSmall`] if the head's windows do not; [`Error::NotFinite`] if a value is
    /// NaN or infinite, [`Error::Overflow`] if activations are.
    pub fn infer(&mut self, clips: ArrayView5<'_, f32>) -> Result<Scores<'_>, Error> {
        check_frames(self.form, clips.dim().2)?;
        Ok(self.network.infer(clips)?.scores())
    }

    /// Multiplications and additions for one clip of the size that the network was loaded for.
    pub fn operations(&self) -> u64 {
        self.network.operations()
    }

    /// How many classes there are: the width of the logits. 0 for a checkpoint without a head.
    pub fn classes(&self) -> usize {
        self.network.classes()
    }

    /// How many features the last layer sees: the width of the features.
    pub fn features(&self) -> usize {
        self.network.features()
    }
}

fn check_frames(form: SlowFastForm, frames: usize) -> Result<(), Error> {
    let slowness = form.slowness();
    let expected = match form {
        SlowFastForm::PyTorchVideo => FRAMES,
        _ => frames.next_multiple_of(slowness).max(slowness),
    };
    if frames == expected { Ok(()) } else { Err(Error::FrameCount { frames, expected }) }
}

pub(super) fn graph(form: SlowFastForm) -> Graph {
    let depth = form.depth();
    let [slow, fast] = form.naming();
    let slow = Backbone::slow(depth, slow);
    let thin = Backbone::of_images(depth, fast);
    let fast =
        Backbone { width: slow.width / THINNESS, stem_frames: 5, frames: [3, 3, 3, 3], ..thin };
    let mut graph = Graph::new();
    let slowness = form.slowness();
    let taken = match form {
        SlowFastForm::PyTorchVideo => Frames::Spread(slowness),
        _ => Frames::Every(slowness),
    };
    let slow_clip = graph.sampled_input(3, taken);
    let fast_clip = graph.input(3);
    let mut y = fast.stem(&mut graph, fast_clip);
    let mut x = slow.stem(&mut graph, slow_clip);
    for stage in 1..=4 {
        let lateral = form.lateral(stage - 1, graph.channels(y));
        let lateral = graph.convolution(y, lateral);
        let both = graph.concatenation(&[x, lateral]);
        y = fast.stage(&mut graph, stage, y);
        x = slow.stage(&mut graph, stage, both);
    }
    match form {
        SlowFastForm::PyTorchVideo => {
            let windows = |frames| Pooling::Windows([frames, 7, 7]);
            let pooled = [(x, windows(FRAMES / slowness)), (y, windows(FRAMES))];
            graph.classify(&pooled, "blocks.6.proj");
        }
        _ => graph.classify(&[(y, Pooling::Mean), (x, Pooling::Mean)], "cls_head.fc_cls"),
    }
    graph
}
