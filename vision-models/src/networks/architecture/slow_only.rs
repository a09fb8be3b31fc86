//! SlowOnly: the slow path of SlowFast alone.

use crate::engine::{Graph, Pooling};

use super::backbone::{Backbone, ResNetDepth};
use super::naming::Naming;

/// The variant of SlowOnly that a checkpoint holds. The variants differ in depth, names and
/// pooling.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlowOnlyForm {
    /// mmaction2's with a ResNet-50. It pools the mean over all frames and positions.
    MmAction2,
    /// mmaction2's with a ResNet-18.
    MmAction2Depth18,
    /// mmaction2's with a ResNet-101.
    MmAction2Depth101,
    /// PyTorchVideo's `slow_r50`. It pools the mean of the windows of 8 × 7 × 7, which differs from
    /// mmaction2's unless the clip has 8 frames of 224 × 224.
    PyTorchVideo,
}

impl SlowOnlyForm {
    /// Returns the depth of its ResNet.
    pub fn depth(self) -> ResNetDepth {
        match self {
            Self::MmAction2 | Self::PyTorchVideo => ResNetDepth::Fifty,
            Self::MmAction2Depth18 => ResNetDepth::Eighteen,
            Self::MmAction2Depth101 => ResNetDepth::OneHundredOne,
        }
    }
}

pub(in crate::networks) fn graph(form: SlowOnlyForm) -> Graph {
    let depth = form.depth();
    let (naming, classifier, pooling) = if form == SlowOnlyForm::PyTorchVideo {
        (Naming::PyTorchVideo, "blocks.5.proj", Pooling::Windows([8, 7, 7]))
    } else {
        (Naming::MmAction2("backbone."), "cls_head.fc_cls", Pooling::Mean)
    };
    let mut graph = Graph::new();
    let clip = graph.input(3);
    let x = Backbone::slow(depth, naming).whole(&mut graph, clip);
    graph.classify(&[(x, pooling)], classifier);
    graph
}
