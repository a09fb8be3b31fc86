//! A network as a graph of layers.

use crate::kernels::{Alignment, Window};

use super::head::Pooling;
use super::layer::Convolution;

/// An activation of a [`Graph`]: the output of one layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Value(pub(super) usize);

/// The frames of a clip that an input takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frames {
    /// All frames.
    All,
    /// Frames in this number, spread evenly from the first to the last.
    Spread(usize),
    /// Frames at this interval, beginning with the first.
    Every(usize),
}

impl Frames {
    /// Returns how many frames are taken from a clip of `given` frames.
    pub(super) fn taken(self, given: usize) -> usize {
        match self {
            Self::All => given,
            Self::Spread(part) | Self::Every(part) => given.checked_div(part).unwrap_or(0),
        }
    }

    /// Returns the index of the clip's frame that is the `index`-th of `taken`.
    pub(super) fn source(self, index: usize, taken: usize, given: usize) -> usize {
        match self {
            Self::All => index,
            Self::Spread(_) => index * (given - 1) / (taken - 1).max(1),
            Self::Every(step) => index * step,
        }
    }
}

/// Computation of an activation.
#[derive(Clone, Debug)]
pub(super) enum Node {
    Input(Frames),
    Convolution { layer: Convolution, input: Value, shortcut: Option<Value> },
    MaxPool { window: Window, input: Value },
    Concatenation { parts: Vec<Value> },
    Resize { size: [usize; 2], alignment: Alignment, input: Value },
    Reshape { size: [usize; 3], input: Value },
}

/// The end of a classifier: activations are pooled to features and given to a linear layer.
#[derive(Clone, Debug)]
pub(super) struct Head {
    /// The pooled parts, whose features are concatenated.
    pub(super) pooled: Vec<(Value, Pooling)>,
    /// The name of the linear layer, without `.weight`.
    pub(super) classifier: String,
}

/// The structure of a network: its layers, the names of their weights, and its outputs.
///
/// Every method that adds a layer returns its activation. Errors of the graph (channels, shapes, a
/// value of another graph) are reported when the network is loaded, with the layer's name. The
/// memory of an activation is reused after its last read. Residual connections and concatenations
/// are computed in place wherever possible.
///
/// ```
/// use vision_models::engine::{Activation::Relu, Convolution, Graph, Pooling};
///
/// let mut graph = Graph::new();
/// let image = graph.input(3);
/// let stem = Convolution::image("stem", 16, [3, 3]).bias().activation(Relu);
/// let x = graph.convolution(image, stem);
/// let layer = |name| Convolution::image(name, 16, [3, 3]).bias().activation(Relu);
/// let y = graph.convolution(x, layer("block.0"));
/// let x = graph.residual(y, layer("block.1"), x);
/// let both = graph.concatenation(&[x, y]);
/// graph.output(both);
/// graph.classify(&[(both, Pooling::Mean)], "classifier");
/// assert_eq!(graph.channels(both), 32);
/// ```
#[derive(Clone, Debug, Default)]
pub struct Graph {
    pub(super) nodes: Vec<Node>,
    channels: Vec<usize>,
    pub(super) outputs: Vec<Value>,
    pub(super) head: Option<Head>,
}

impl Graph {
    /// Creates a graph without layers.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds an input: an image or clip with this number of channels.
    pub fn input(&mut self, channels: usize) -> Value {
        self.sampled_input(channels, Frames::All)
    }

    /// Adds an input that takes some frames of the clip.
    pub fn sampled_input(&mut self, channels: usize, frames: Frames) -> Value {
        self.push(Node::Input(frames), channels)
    }

    /// Adds a convolution with its batch norm and activation.
    pub fn convolution(&mut self, input: Value, layer: Convolution) -> Value {
        let outputs = layer.outputs;
        self.push(Node::Convolution { layer, input, shortcut: None }, outputs)
    }

    /// Adds the end of a residual block: activation(layer(input) + shortcut).
    pub fn residual(&mut self, input: Value, layer: Convolution, shortcut: Value) -> Value {
        let outputs = layer.outputs;
        self.push(Node::Convolution { layer, input, shortcut: Some(shortcut) }, outputs)
    }

    /// Adds max pooling. Values outside the input do not count. The padding is at most half the
    /// kernel, and dilation is not allowed.
    pub fn max_pool(&mut self, input: Value, window: Window) -> Value {
        let channels = self.channels(input);
        self.push(Node::MaxPool { window, input }, channels)
    }

    /// Concatenates the channels of all parts.
    pub fn concatenation(&mut self, parts: &[Value]) -> Value {
        let channels =
            parts.iter().fold(0_usize, |sum, &part| sum.saturating_add(self.channels(part)));
        self.push(Node::Concatenation { parts: parts.to_vec() }, channels)
    }

    /// Adds bilinear interpolation of each channel to this number of rows and columns.
    pub fn resize(&mut self, input: Value, size: [usize; 2], alignment: Alignment) -> Value {
        let channels = self.channels(input);
        self.push(Node::Resize { size, alignment, input }, channels)
    }

    /// Returns the same elements with another number of frames, rows, columns and channels. Their
    /// order stays: frames, rows, columns, channels, the last fastest.
    pub fn reshape(&mut self, input: Value, size: [usize; 3], channels: usize) -> Value {
        self.push(Node::Reshape { size, input }, channels)
    }

    /// Makes an activation an output. [`Inference::map`](super::Inference::map) returns the outputs
    /// in the order of these calls.
    pub fn output(&mut self, value: Value) {
        self.outputs.push(value);
    }

    /// Pools activations to features and adds a linear layer.
    ///
    /// Its tensors are `classifier.weight` and `classifier.bias`, or `classifier.1.weight` and
    /// `classifier.1.bias` as after a dropout. Their shape gives the number of classes. If the
    /// checkpoint has none of these tensors, the network returns features only.
    pub fn classify(&mut self, pooled: &[(Value, Pooling)], classifier: impl Into<String>) {
        self.head = Some(Head { pooled: pooled.to_vec(), classifier: classifier.into() });
    }

    /// Returns the number of channels of an activation, or 0 if it belongs to another graph.
    pub fn channels(&self, value: Value) -> usize {
        self.channels.get(value.0).copied().unwrap_or(0)
    }

    fn push(&mut self, node: Node, channels: usize) -> Value {
        self.nodes.push(node);
        self.channels.push(channels);
        Value(self.nodes.len() - 1)
    }
}
