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

pub(in crate::networks) fn graph(form: SlowOnlyForm) -> Graph {
    let mmaction2 = Naming::MmAction2("backbone.");
    let (depth, naming, classifier, pooling) = match form {
        SlowOnlyForm::MmAction2 => {
            (ResNetDepth::Fifty, mmaction2, "cls_head.fc_cls", Pooling::Mean)
        }
        SlowOnlyForm::MmAction2Depth18 => {
            (ResNetDepth::Eighteen, mmaction2, "cls_head.fc_cls", Pooling::Mean)
        }
        SlowOnlyForm::MmAction2Depth101 => {
            (ResNetDepth::OneHundredOne, mmaction2, "cls_head.fc_cls", Pooling::Mean)
        }
        SlowOnlyForm::PyTorchVideo => {
            let windows = Pooling::Windows([8, 7, 7]);
            (ResNetDepth::Fifty, Naming::PyTorchVideo, "blocks.5.proj", windows)
        }
    };
    let mut graph = Graph::new();
    let clip = graph.input(3);
    let x = Backbone::slow(depth, naming).whole(&mut graph, clip);
    graph.classify(&[(x, pooling)], classifier);
    graph
}
