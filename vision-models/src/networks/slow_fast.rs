//! SlowFast: a slow path that sees few frames, and a thin fast one that sees them all.

use ndarray::ArrayView5;

use crate::kernels::Window;
use crate::{Error, TensorSource};

use super::backbone::{Backbone, ResNetDepth};
use super::graph::{Architecture, Graph, Layer, Names, Value};
use super::head::Pooling;
use super::kind::NetworkKind;
use super::naming::Naming;
use super::network::{Clips, Network, Options, Scores};

/// Frames of a clip: the windows of the head leave no choice.
const FRAMES: usize = 32;
/// Frames of the fast path to one of the slow path (α).
const SLOWNESS: usize = 4;
/// Channels of the slow path to one of the fast path (1/β).
const THINNESS: usize = 8;
/// Channels of a lateral connection to one of the fast path.
const LATERAL: usize = 2;

/// SlowFast-R50 in PyTorchVideo's form (`slowfast_r50`): class scores of a clip. C. Feichtenhofer,
/// H. Fan, J. Malik and K. He, "SlowFast networks for video recognition", ICCV 2019, Table 1.
#[derive(Debug)]
pub struct SlowFast(Network);

impl SlowFast {
    /// The names and shapes of the tensors that a checkpoint with this many classes must hold.
    pub fn parameters(classes: usize) -> Vec<(String, Vec<usize>)> {
        architecture().expected(classes).into_tensors()
    }

    /// Takes the weights of a checkpoint and packs them for clips of 32 frames of
    /// `height` × `width` (other heights and widths run too, less fast). The slow path takes eight
    /// of the frames, spread evenly from the first to the last.
    ///
    /// # Errors
    /// [`Error::Weights`] with every tensor that is missing, surplus or misshapen; [`Error::Weight`]
    /// for one that is not finite and for negative variances, [`Error::FoldedWeights`];
    /// [`Error::InputTooSmall`] if the frames are too small; [`Error::Threads`] for a number of
    /// threads that cannot be started.
    pub fn load(
        tensors: impl TensorSource,
        [height, width]: [usize; 2],
        options: Options,
    ) -> Result<Self, Error> {
        let size = [FRAMES, height, width];
        Network::load(NetworkKind::SlowFast, Box::new(tensors), size, options).map(Self)
    }

    /// The scores of normalised clips, N × 3 × 32 × height × width.
    ///
    /// # Errors
    /// [`Error::InputShape`] if there are not three channels or no clips; [`Error::FrameCount`] if
    /// the frames are not 32; [`Error::InputTooSmall`] if a kernel does not fit,
    /// [`Error::PoolTooSmall`] if the head's windows do not; [`Error::NotFinite`] if a value is
    /// NaN or infinite, [`Error::Overflow`] if activations are.
    pub fn infer(&mut self, clips: ArrayView5<'_, f32>) -> Result<Scores<'_>, Error> {
        let frames = clips.dim().2;
        if frames != FRAMES {
            return Err(Error::FrameCount { frames, expected: FRAMES });
        }
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

pub(super) fn architecture() -> Architecture {
    let depth = ResNetDepth::Fifty;
    let path = Naming::PyTorchVideoPathway;
    let slow = Backbone { depth, naming: path(0), width: 64, stem_frames: 1, frames: [1, 1, 3, 3] };
    let fast = Backbone {
        depth,
        naming: path(1),
        width: 64 / THINNESS,
        stem_frames: 5,
        frames: [3, 3, 3, 3],
    };
    let mut graph = Graph::default();
    let [slow_clip, fast_clip] = [graph.value(3), graph.value(3)];
    let mut y = fast.stem(&mut graph, fast_clip, 0);
    let spare = LATERAL * fast.channels(0);
    let mut x = slow.stem(&mut graph, slow_clip, spare);
    for stage in 1..=4 {
        lateral(&mut graph, stage - 1, y, x);
        y = fast.stage(&mut graph, stage, y, 0);
        let spare = if stage < 4 { LATERAL * fast.channels(stage) } else { 0 };
        x = slow.stage(&mut graph, stage, x, spare);
    }
    Architecture {
        graph,
        inputs: vec![(slow_clip, SLOWNESS), (fast_clip, 1)],
        outputs: vec![
            (x, Pooling::Windows([FRAMES / SLOWNESS, 7, 7])),
            (y, Pooling::Windows([FRAMES, 7, 7])),
        ],
        classifier: "blocks.6.proj",
    }
}

/// 7×1×1 with stride α from the fast path into the slow one's last channels.
fn lateral(graph: &mut Graph, block: usize, fast: Value, slow: Value) {
    let inputs = graph.channels[fast.0];
    let outputs = LATERAL * inputs;
    let prefix = format!("blocks.{block}.multipathway_fusion");
    let layer = Layer {
        names: Names {
            convolution: format!("{prefix}.conv_fast_to_slow"),
            norm: format!("{prefix}.norm"),
        },
        inputs,
        outputs,
        window: Window { kernel: [7, 1, 1], stride: [SLOWNESS, 1, 1], padding: [3, 0, 0] },
        axes: 3,
    };
    let first_channel = graph.channels[slow.0] - outputs;
    graph.convolve_into(fast, layer, slow, first_channel, true);
}
