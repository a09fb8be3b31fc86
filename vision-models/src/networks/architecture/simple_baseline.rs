//! The pose network of "Simple baselines".

use crate::engine::{Activation, Convolution, Graph};

use super::backbone::{Backbone, ResNetDepth};
use super::naming::Naming;

/// The origin of a checkpoint of the simple baseline. It decides the names, and the order of
/// colours in training.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SimpleBaselineForm {
    /// Microsoft's `human-pose-estimation.pytorch`. The network reads blue, green, red.
    Microsoft,
    /// mmpose's before version 1.0, with the prefixes `backbone.` and `keypoint_head.`.
    MmPose0,
    /// mmpose's since version 1.0, with the prefixes `backbone.` and `head.`.
    MmPose1,
}

impl SimpleBaselineForm {
    pub(in crate::networks) const ALL: [Self; 3] = [Self::Microsoft, Self::MmPose0, Self::MmPose1];

    /// Returns the prefixes of backbone and head.
    fn prefixes(self) -> (&'static str, &'static str) {
        match self {
            Self::Microsoft => ("", ""),
            Self::MmPose0 => ("backbone.", "keypoint_head."),
            Self::MmPose1 => ("backbone.", "head."),
        }
    }

    /// Returns the only form that could have these names.
    pub(crate) fn guess(names: &[&str]) -> Self {
        let has =
            |module: &str| names.iter().any(|name| name.split('.').any(|part| part == module));
        if has("keypoint_head") {
            Self::MmPose0
        } else if has("head") {
            Self::MmPose1
        } else {
            Self::Microsoft
        }
    }
}

/// Builds a ResNet-50, three transposed convolutions and a map for each of COCO's seventeen joints.
/// B. Xiao, H. Wu and Y. Wei, "Simple baselines for human pose estimation and tracking", ECCV 2018,
/// Sec. 2.
pub(in crate::networks) fn graph(form: SimpleBaselineForm) -> Graph {
    let (backbone, head) = form.prefixes();
    let mut graph = Graph::new();
    let image = graph.input(3);
    let backbone = Backbone::of_images(ResNetDepth::Fifty, Naming::Torchvision(backbone));
    let mut x = backbone.whole(&mut graph, image);
    for layer in [0, 3, 6] {
        let up = Convolution::transposed_image(format!("{head}deconv_layers.{layer}"), 256, [4, 4])
            .stride([1, 2, 2])
            .padding([0, 1, 1])
            .norm(format!("{head}deconv_layers.{}", layer + 1))
            .activation(Activation::Relu);
        x = graph.convolution(x, up);
    }
    let maps = Convolution::image(format!("{head}final_layer"), 17, [1, 1]).bias();
    let maps = graph.convolution(x, maps);
    graph.output(maps);
    graph
}
