//! Checks of a graph before it is computed.

use crate::error::Error;
use crate::kernels::Window;

use super::graph::{Graph, Node, Value};
use super::layer::{Activation, Convolution};

/// Largest kernel, stride, padding and dilation. No network exceeds it, and sums and products of a
/// few do not overflow.
const MAX_WINDOW: usize = 1 << 12;
/// Largest number of channels, chosen for the same reasons.
const MAX_CHANNELS: usize = 1 << 24;

/// Checks everything that does not depend on the input's size.
///
/// # Errors
/// [`Error::Layer`].
pub(super) fn validate(graph: &Graph) -> Result<(), Error> {
    let mut clip_channels = None;
    for (at, node) in graph.nodes.iter().enumerate() {
        let channels = graph.channels(Value(at));
        let problem = match node {
            Node::Input(_) if *clip_channels.get_or_insert(channels) != channels => {
                Some("all inputs are frames of one clip and have its channels".into())
            }
            Node::Input(frames) if frames.taken(usize::MAX) == 0 => {
                Some("an input takes one of at least one frames".into())
            }
            Node::Input(_) => None,
            Node::Convolution { layer, input, shortcut } => {
                unknown(at, [input].into_iter().chain(shortcut))
                    .or_else(|| convolution(layer, graph.channels(*input)))
                    .or_else(|| {
                        let other = graph.channels((*shortcut)?);
                        (other != layer.outputs).then(|| {
                            format!("it adds {} channels to {other}", layer.outputs)
                        })
                    })
            }
            Node::MaxPool { window: shape, input } => unknown(at, [input]).or_else(|| {
                window(shape).or_else(|| {
                    let too_wide = (0..3).any(|axis| !shape.stays_inside(axis));
                    (too_wide || shape.dilation != [1; 3]).then(|| {
                        "the padding of a pooling is at most half its kernel, less than the kernel behind, and it has no dilation".into()
                    })
                })
            }),
            Node::Resize { size, input, .. } => unknown(at, [input])
                .or_else(|| size.contains(&0).then(|| "it has no rows or no columns".into())),
            Node::Reshape { input, .. } => unknown(at, [input]),
            Node::Concatenation { parts } => unknown(at, parts)
                .or_else(|| parts.is_empty().then(|| "a concatenation has at least one part".into())),
        };
        let too_many = || {
            let range = 1..=MAX_CHANNELS;
            (!range.contains(&channels)).then(|| {
                format!("{channels} channels: give at least one and at most {MAX_CHANNELS}")
            })
        };
        if let Some(problem) = problem.or_else(too_many) {
            return Err(Error::Layer { layer: name(node), problem });
        }
    }
    let refuse = |layer: &str, problem: &str| {
        Err(Error::Layer { layer: layer.into(), problem: problem.into() })
    };
    if clip_channels.is_none() {
        return refuse("graph", "it has no input");
    }
    let pooled = graph.head.iter().flat_map(|head| &head.pooled).map(|(value, _)| value);
    if unknown(graph.nodes.len(), graph.outputs.iter().chain(pooled)).is_some() {
        return refuse("output", "it is no value of this graph");
    }
    match &graph.head {
        Some(head) if head.pooled.is_empty() => refuse("head", "it pools no activation"),
        None if graph.outputs.is_empty() => refuse("graph", "it has no output"),
        _ => Ok(()),
    }
}

/// Returns the problem if a node reads a value that no earlier node gives.
fn unknown<'a>(at: usize, values: impl IntoIterator<Item = &'a Value>) -> Option<String> {
    let is_unknown = values.into_iter().any(|value| value.0 >= at);
    is_unknown.then(|| "it reads a value that is not of this graph".into())
}

fn convolution(layer: &Convolution, inputs: usize) -> Option<String> {
    let Convolution { outputs, groups, transposed, window: shape, .. } = layer;
    let divides = |channels: usize| channels.checked_rem(*groups) == Some(0);
    if !divides(inputs) || !divides(*outputs) {
        return Some(format!(
            "{groups} groups do not divide {inputs} inputs and {outputs} outputs"
        ));
    }
    if *transposed {
        if shape.dilation != [1; 3] {
            return Some("a transposed convolution has no dilation".into());
        }
        if shape.extra != [0; 3] {
            return Some("a transposed convolution has no extra padding".into());
        }
        if (0..3).any(|axis| shape.kernel[axis] < shape.stride[axis]) {
            return Some(
                "the kernel of a transposed convolution is not smaller than its stride".into(),
            );
        }
    }
    let epsilon = layer.norm.as_ref().map_or(0.0, |norm| norm.epsilon);
    if !epsilon.is_finite() || epsilon < 0.0 {
        return Some(format!("ε = {epsilon}: give a finite number, zero or more"));
    }
    if let Activation::Prelu { name, .. } = &layer.activation
        && *name == layer.name
    {
        return Some("slopes and weights have one name".into());
    }
    window(shape)
}

fn window(window: &Window) -> Option<String> {
    let Window { kernel, stride, padding, dilation, extra } = window;
    let counts = kernel.iter().chain(stride).chain(dilation);
    let wrong = counts.copied().any(|count| !(1..=MAX_WINDOW).contains(&count))
        || padding.iter().any(|&padding| padding > MAX_WINDOW)
        || extra.iter().any(|&extra| extra.unsigned_abs() > MAX_WINDOW);
    wrong.then(|| {
        format!("kernel, stride and dilation are from 1 to {MAX_WINDOW}, the padding not larger")
    })
}

/// Returns a node's name for errors.
fn name(node: &Node) -> String {
    match node {
        Node::Input(_) => "input".into(),
        Node::Convolution { layer, .. } => layer.name.clone(),
        Node::MaxPool { .. } => "max pool".into(),
        Node::Concatenation { .. } => "concatenation".into(),
        Node::Resize { .. } => "resize".into(),
        Node::Reshape { .. } => "reshape".into(),
    }
}
