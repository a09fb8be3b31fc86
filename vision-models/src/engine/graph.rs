//! A network as its papers draw it: layers from one activation to the next.

use crate::kernels::{Alignment, Window};

use super::head::Pooling;
use super::layer::Convolution;

/// An activation of a [`Graph`]: one box between the arrows of a paper's figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Value(pub(super) usize);

/// Which frames of the given clip an input takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frames {
    /// All.
    All,
    /// One of so many, spread evenly from the first to the last.
    Spread(usize),
    /// Every so-manieth from the first on.
    Every(usize),
}

impl Frames {
    /// How many frames it takes of so many.
    pub(super) fn taken(self, given: usize) -> usize {
        match self {
            Self::All => given,
            Self::Spread(part) | Self::Every(part) => given.checked_div(part).unwrap_or(0),
        }
    }

    /// The frame that is taken as the `index`-th of `taken`.
    pub(super) fn source(self, index: usize, taken: usize, given: usize) -> usize {
        match self {
            Self::All => index,
            Self::Spread(_) => index * (given - 1) / (taken - 1).max(1),
            Self::Every(step) => index * step,
        }
    }
}

/// How an activation comes about.
#[derive(Clone, Debug)]
pub(super) enum Node {
    Input(Frames),
    Convolution { layer: Convolution, input: Value, shortcut: Option<Value> },
    MaxPool { window: Window, input: Value },
    Concatenation { parts: Vec<Value> },
    Resize { size: [usize; 2], alignment: Alignment, input: Value },
    Reshape { size: [usize; 3], input: Value },
}

/// The end of a classifier: activations pooled to features, then a linear layer.
#[derive(Clone, Debug)]
pub(super) struct Head {
    /// The features are those of the parts, one behind the other.
    pub(super) pooled: Vec<(Value, Pooling)>,
    /// What the linear layer is called, without `.weight`.
    pub(super) classifier: String,
}

/// A network to be: its layers, what their weights are called, and what it gives.
///
/// Every method that adds a layer gives its activation. What does not fit (channels, shapes, a value of
/// another graph) is an error when the network is loaded, with the layer's name. Activations that are read no
/// more give up their memory; a residual connection and a concatenation are computed in place wherever that
/// is possible.
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
    /// A network without layers.
    pub fn new() -> Self {
        Self::default()
    }

    /// An image or clip of so many channels, as it is given.
    pub fn input(&mut self, channels: usize) -> Value {
        self.sampled_input(channels, Frames::All)
    }

    /// Some frames of the given clip.
    pub fn sampled_input(&mut self, channels: usize, frames: Frames) -> Value {
        self.push(Node::Input(frames), channels)
    }

    /// A convolution, with the batch norm and the activation that are part of it.
    pub fn convolution(&mut self, input: Value, layer: Convolution) -> Value {
        let outputs = layer.outputs;
        self.push(Node::Convolution { layer, input, shortcut: None }, outputs)
    }

    /// The end of a residual block: activation(layer(input) + shortcut).
    pub fn residual(&mut self, input: Value, layer: Convolution, shortcut: Value) -> Value {
        let outputs = layer.outputs;
        self.push(Node::Convolution { layer, input, shortcut: Some(shortcut) }, outputs)
    }

    /// The largest value of each window; what lies outside the input does not count. The padding is at most
    /// half the kernel, and there is no dilation.
    pub fn max_pool(&mut self, input: Value, window: Window) -> Value {
        let channels = self.channels(input);
        self.push(Node::MaxPool { window, input }, channels)
    }

    /// The channels of all parts, one behind the other.
    pub fn concatenation(&mut self, parts: &[Value]) -> Value {
        let channels =
            parts.iter().fold(0_usize, |sum, &part| sum.saturating_add(self.channels(part)));
        self.push(Node::Concatenation { parts: parts.to_vec() }, channels)
    }

    /// The bilinear interpolation of each channel to so many rows and columns.
    pub fn resize(&mut self, input: Value, size: [usize; 2], alignment: Alignment) -> Value {
        let channels = self.channels(input);
        self.push(Node::Resize { size, alignment, input }, channels)
    }

    /// The same elements as so many frames, rows and columns of so many channels. They keep their order: frames,
    /// rows, columns, channels, the last fastest.
    pub fn reshape(&mut self, input: Value, size: [usize; 3], channels: usize) -> Value {
        self.push(Node::Reshape { size, input }, channels)
    }

    /// Makes an activation an output: [`Inference::map`](super::Inference::map) gives it, by the order of
    /// these calls.
    pub fn output(&mut self, value: Value) {
        self.outputs.push(value);
    }

    /// Pools activations to features, and gives them to a linear layer: tensors `classifier.weight` and
    /// `classifier.bias`, or `classifier.1.weight` and `classifier.1.bias` as behind a dropout. The checkpoint
    /// says how many classes there are. If it has none of these tensors, the network gives features alone.
    pub fn classify(&mut self, pooled: &[(Value, Pooling)], classifier: impl Into<String>) {
        self.head = Some(Head { pooled: pooled.to_vec(), classifier: classifier.into() });
    }

    /// The channels of an activation; 0 for one of another graph.
    pub fn channels(&self, value: Value) -> usize {
        self.channels.get(value.0).copied().unwrap_or(0)
    }

    fn push(&mut self, node: Node, channels: usize) -> Value {
        self.nodes.push(node);
        self.channels.push(channels);
        Value(self.nodes.len() - 1)
    }
}
