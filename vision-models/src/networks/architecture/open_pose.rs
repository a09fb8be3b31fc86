//! The body network of OpenPose.

use crate::engine::{Activation, Convolution, Graph, Value, Window};

/// The naming scheme of a checkpoint of OpenPose's body network.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OpenPoseForm {
    /// The names of the Caffe model: `conv1_1.weight`.
    Caffe,
    /// Names of the Caffe model behind module names, as in a port to PyTorch:
    /// `model0.conv1_1.weight`.
    Modules,
}

impl OpenPoseForm {
    pub(in crate::networks) const ALL: [Self; 2] = [Self::Caffe, Self::Modules];

    /// Returns the only form that could have these names.
    pub(crate) fn guess(names: &[&str]) -> Self {
        let is_module = names.iter().any(|name| name.split('.').any(|part| part == "model0"));
        if is_module { Self::Modules } else { Self::Caffe }
    }

    /// Returns a layer's name, given its module: stage and branch, 0 and 0 for the front.
    fn name(self, [stage, branch]: [usize; 2], layer: &str) -> String {
        match (self, stage) {
            (Self::Caffe, _) => layer.to_owned(),
            (Self::Modules, 0) => format!("model0.{layer}"),
            (Self::Modules, _) => format!("model{stage}_{branch}.{layer}"),
        }
    }
}

/// Number of stages that refine the maps.
const STAGES: usize = 6;
/// Channels of the two branches: two for each of nineteen limbs, and one for each of eighteen
/// joints and the background.
const BRANCHES: [usize; 2] = [38, 19];

/// Builds ten layers of VGG-19 and two more, then six stages of two branches. The outputs are the
/// fields of the limbs and the joints' maps, an eighth of the image's size.
///
/// Z. Cao, T. Simon, S.-E. Wei and Y. Sheikh, "Realtime multi-person 2D pose estimation using part
/// affinity fields", CVPR 2017, Fig. 3, with the COCO model's eighteen joints.
pub(in crate::networks) fn graph(form: OpenPoseForm) -> Graph {
    let mut graph = Graph::new();
    let image = graph.input(3);
    let features = front(&mut graph, form, image);
    let mut maps = BRANCHES;
    let mut joined = features;
    let mut values = Vec::new();
    for stage in 1..=STAGES {
        values = (1..)
            .zip(&mut maps)
            .map(|(branch, &mut outputs)| {
                let names = [stage, branch];
                if stage == 1 {
                    first_stage(&mut graph, form, names, joined, outputs)
                } else {
                    later_stage(&mut graph, form, names, joined, outputs)
                }
            })
            .collect();
        if stage < STAGES {
            let parts: Vec<Value> = values.iter().copied().chain([features]).collect();
            joined = graph.concatenation(&parts);
        }
    }
    for value in values {
        graph.output(value);
    }
    graph
}

fn layer(
    form: OpenPoseForm,
    module: [usize; 2],
    name: &str,
    outputs: usize,
    side: usize,
) -> Convolution {
    Convolution::image(form.name(module, name), outputs, [side, side]).bias()
}

fn front(graph: &mut Graph, form: OpenPoseForm, image: Value) -> Value {
    const LAYERS: [(&str, usize); 12] = [
        ("conv1_1", 64),
        ("conv1_2", 64),
        ("conv2_1", 128),
        ("conv2_2", 128),
        ("conv3_1", 256),
        ("conv3_2", 256),
        ("conv3_3", 256),
        ("conv3_4", 256),
        ("conv4_1", 512),
        ("conv4_2", 512),
        ("conv4_3_CPM", 256),
        ("conv4_4_CPM", 128),
    ];
    let halve = Window { stride: [1, 2, 2], padding: [0; 3], ..Window::same([1, 2, 2]) };
    LAYERS.into_iter().fold(image, |x, (name, outputs)| {
        let layer = layer(form, [0, 0], name, outputs, 3).activation(Activation::Relu);
        let x = graph.convolution(x, layer);
        if matches!(name, "conv1_2" | "conv2_2" | "conv3_4") { graph.max_pool(x, halve) } else { x }
    })
}

fn first_stage(
    graph: &mut Graph,
    form: OpenPoseForm,
    module: [usize; 2],
    mut x: Value,
    maps: usize,
) -> Value {
    let branch = module[1];
    let name = |number: usize| format!("conv5_{number}_CPM_L{branch}");
    for (number, outputs, side) in [(1, 128, 3), (2, 128, 3), (3, 128, 3), (4, 512, 1)] {
        let layer = layer(form, module, &name(number), outputs, side).activation(Activation::Relu);
        x = graph.convolution(x, layer);
    }
    graph.convolution(x, layer(form, module, &name(5), maps, 1))
}

fn later_stage(
    graph: &mut Graph,
    form: OpenPoseForm,
    module: [usize; 2],
    mut x: Value,
    maps: usize,
) -> Value {
    let [stage, branch] = module;
    let name = |number: usize| format!("Mconv{number}_stage{stage}_L{branch}");
    for number in 1..=6 {
        let side = if number == 6 { 1 } else { 7 };
        let layer = layer(form, module, &name(number), 128, side).activation(Activation::Relu);
        x = graph.convolution(x, layer);
    }
    graph.convolution(x, layer(form, module, &name(7), maps, 1))
}
