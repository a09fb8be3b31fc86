//! SlowFast: a slow path that sees few frames, and a thin fast path that sees all of them.

use crate::engine::{Activation, Convolution, Frames, Graph, Pooling};
use crate::error::Error;

use super::backbone::{Backbone, ResNetDepth};
use super::naming::{Names, Naming};

/// Frames of a clip for PyTorchVideo's network. The windows of its head fix it.
const FRAMES: usize = 32;
/// Ratio of the channels of the slow path to those of the fast path (1/β).
const THINNESS: usize = 8;
/// Ratio of the channels of a lateral connection to those of the fast path.
const LATERAL: usize = 2;

/// The variant of SlowFast that a checkpoint holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlowFastForm {
    /// PyTorchVideo's `slowfast_r50`: clips of 32 frames. The slow path takes eight of them, spread
    /// evenly from the first to the last.
    PyTorchVideo,
    /// mmaction2's `8x8`: the slow path takes every fourth frame of the clip, and the lateral
    /// kernels see seven.
    MmAction2EveryFourth(ResNetDepth),
    /// mmaction2's `4x16`: the slow path takes every eighth frame of the clip, and the lateral
    /// kernels see five.
    MmAction2EveryEighth(ResNetDepth),
}

impl SlowFastForm {
    fn depth(self) -> ResNetDepth {
        match self {
            Self::PyTorchVideo => ResNetDepth::Fifty,
            Self::MmAction2EveryFourth(depth) | Self::MmAction2EveryEighth(depth) => depth,
        }
    }

    /// Ratio of the frames of the fast path to those of the slow path (α).
    fn slowness(self) -> usize {
        match self {
            Self::PyTorchVideo | Self::MmAction2EveryFourth(_) => 4,
            Self::MmAction2EveryEighth(_) => 8,
        }
    }

    /// Checks the number of frames of a clip.
    ///
    /// # Errors
    /// [`Error::Size`] if the two paths cannot share the frames.
    pub(in crate::networks) fn check_frames(self, frames: usize) -> Result<(), Error> {
        let slowness = self.slowness();
        let expected = match self {
            Self::PyTorchVideo => FRAMES,
            _ => frames.next_multiple_of(slowness).max(slowness),
        };
        if frames == expected {
            Ok(())
        } else {
            Err(Error::size("a clip", &[frames], "frames", &expected.to_string()))
        }
    }

    /// Returns the names of the slow and the fast path.
    fn naming(self) -> [Naming; 2] {
        match self {
            Self::PyTorchVideo => [0, 1].map(Naming::PyTorchVideoPathway),
            _ => ["backbone.slow_path.", "backbone.fast_path."].map(Naming::MmAction2),
        }
    }

    /// Returns the connection from the fast path to the slow path after a stage. The stem is stage
    /// zero.
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

pub(in crate::networks) fn graph(form: SlowFastForm) -> Graph {
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
