//! A network as its papers draw it: convolutions and poolings from one activation to the next.

use crate::TensorSource;
use crate::kernels::Window;
use crate::layout::Extent;

use super::head::Pooling;
use super::parameters::{Expected, Misfit};

/// An activation: one box between the arrows of a paper's figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Value(pub(crate) usize);

/// What a layer's parameters are called in a checkpoint.
#[derive(Clone, Debug)]
pub(crate) struct Names {
    /// Of the convolution, without `.weight`.
    pub(crate) convolution: String,
    /// Of its batch norm, without `.weight`.
    pub(crate) norm: String,
}

/// A convolution, the batch norm behind it folded in.
#[derive(Clone, Debug)]
pub(crate) struct Layer {
    pub(crate) names: Names,
    pub(crate) inputs: usize,
    pub(crate) outputs: usize,
    pub(crate) window: Window,
    /// How many axes the checkpoint's kernel has: two for images, three for clips.
    pub(crate) axes: usize,
}

impl Layer {
    /// Multiplications and additions for an output of this size.
    pub(crate) fn operations(&self, output: Extent) -> usize {
        let taps: usize = self.window.kernel.iter().product();
        2 * output.iter().product::<usize>() * taps * self.inputs * self.outputs
    }
}

/// One step of the forward pass.
#[derive(Clone, Debug)]
pub(crate) enum Step {
    /// output\[from `first_channel`\] = \[relu\](layer(input) \[+ output\])
    Convolution {
        layer: usize,
        input: Value,
        output: Value,
        first_channel: usize,
        add: bool,
        relu: bool,
    },
    /// The largest of each window, behind a ReLU.
    MaxPool { window: Window, input: Value, output: Value },
}

impl Step {
    pub(crate) fn input(&self) -> Value {
        match *self {
            Self::Convolution { input, .. } | Self::MaxPool { input, .. } => input,
        }
    }

    pub(crate) fn output(&self) -> Value {
        match *self {
            Self::Convolution { output, .. } | Self::MaxPool { output, .. } => output,
        }
    }

    /// The channels that the step reads, and those that it writes: how many from the first, and up to
    /// which.
    pub(crate) fn channels(&self, graph: &Graph) -> [usize; 2] {
        match *self {
            Self::Convolution { layer, first_channel, .. } => {
                let Layer { inputs, outputs, .. } = graph.layers[layer];
                [inputs, first_channel + outputs]
            }
            Self::MaxPool { input, .. } => [graph.channels[input.0]; 2],
        }
    }

    /// Whether the step adds to what its output holds.
    pub(crate) fn adds(&self) -> bool {
        matches!(self, Self::Convolution { add: true, .. })
    }

    /// What errors call the step.
    pub(crate) fn name(&self, layers: &[Layer]) -> String {
        match *self {
            Self::Convolution { layer, .. } => layers[layer].names.convolution.clone(),
            Self::MaxPool { .. } => "max pool".into(),
        }
    }

    /// How the step looks at its input.
    pub(crate) fn window(&self, layers: &[Layer]) -> Window {
        match *self {
            Self::Convolution { layer, .. } => layers[layer].window,
            Self::MaxPool { window, .. } => window,
        }
    }
}

/// A network up to its head.
#[derive(Clone, Debug, Default)]
pub(crate) struct Graph {
    /// The channels of each value.
    pub(crate) channels: Vec<usize>,
    pub(crate) layers: Vec<Layer>,
    pub(crate) steps: Vec<Step>,
}

impl Graph {
    /// A new activation of this many channels.
    pub(crate) fn value(&mut self, channels: usize) -> Value {
        self.channels.push(channels);
        Value(self.channels.len() - 1)
    }

    /// A convolution of the first `layer.inputs` channels of `input` into a new activation.
    pub(crate) fn convolve(&mut self, input: Value, layer: Layer, relu: bool) -> Value {
        let output = self.value(layer.outputs);
        self.convolve_into(input, layer, output, 0, relu);
        output
    }

    /// A convolution into the channels of an activation from `first_channel` on.
    pub(crate) fn convolve_into(
        &mut self,
        input: Value,
        layer: Layer,
        output: Value,
        first_channel: usize,
        relu: bool,
    ) {
        self.push(input, layer, output, first_channel, false, relu);
    }

    /// output = relu(layer(input) + output), where a residual block ends.
    pub(crate) fn convolve_add(&mut self, input: Value, layer: Layer, output: Value) {
        self.push(input, layer, output, 0, true, true);
    }

    fn push(
        &mut self,
        input: Value,
        layer: Layer,
        output: Value,
        first_channel: usize,
        add: bool,
        relu: bool,
    ) {
        self.layers.push(layer);
        let layer = self.layers.len() - 1;
        self.steps.push(Step::Convolution { layer, input, output, first_channel, add, relu });
    }

    /// A max pool into the first channels of an activation.
    pub(crate) fn max_pool(&mut self, input: Value, output: Value, window: Window) {
        self.steps.push(Step::MaxPool { window, input, output });
    }
}

/// A network with its ends.
#[derive(Clone, Debug)]
pub(crate) struct Architecture {
    pub(crate) graph: Graph,
    /// Clips, and how many of the given frames there are to one of theirs.
    pub(crate) inputs: Vec<(Value, usize)>,
    /// Last activations, one behind the other in the features.
    pub(crate) outputs: Vec<(Value, Pooling)>,
    /// What the linear layer behind the features is called.
    pub(crate) classifier: &'static str,
}

impl Architecture {
    /// How many features the linear layer sees.
    pub(crate) fn features(&self) -> usize {
        self.outputs.iter().map(|(value, _)| self.graph.channels[value.0]).sum()
    }

    /// The tensors of a checkpoint with this many classes.
    pub(crate) fn expected(&self, classes: usize) -> Expected {
        let mut expected = Expected::default();
        for layer in &self.graph.layers {
            expected.convolution(layer);
        }
        expected.linear(self.classifier, self.features(), classes);
        expected
    }

    /// Holds a checkpoint against what this network takes. Gives the number of classes, which the
    /// checkpoint says.
    pub(crate) fn check(&self, tensors: &dyn TensorSource) -> Result<usize, Misfit> {
        let weight = format!("{}.weight", self.classifier);
        let classes = tensors.shape(&weight).and_then(|shape| shape.first().copied());
        let classes = classes.filter(|&classes| classes > 0).unwrap_or(1);
        self.expected(classes).check(tensors)?;
        Ok(classes)
    }

    /// Frames, rows and columns of each input for a clip of this size.
    pub(crate) fn input_sizes(&self, [frames, rows, columns]: Extent) -> Vec<(Value, Extent)> {
        let size = |&(value, slowness)| (value, [frames / slowness, rows, columns]);
        self.inputs.iter().map(size).collect()
    }

    /// The value and the step at which the first kernel with a temporal extent comes: before it,
    /// each frame is on its own.
    pub(crate) fn first_temporal_step(&self) -> Option<(Value, usize)> {
        let is_temporal = |step: &Step| step.window(&self.graph.layers).kernel[0] > 1;
        let at = self.graph.steps.iter().position(is_temporal)?;
        Some((self.graph.steps[at].input(), at))
    }
}
