//! Turns a graph into steps, and decides which values share an activation.
//!
//! Concatenations and residual connections are computed in place where no other step reads the
//! overwritten memory: a part of a concatenation is written into it, and a residual block adds to
//! its shortcut. All others are copied.

use crate::error::Error;

use super::graph::{Graph, Head, Node, Value};
use super::program::{Classifier, Layer, Program, Slot, Step};
use super::validation::validate;

/// Turns a graph into steps.
///
/// # Errors
/// [`Error::Layer`] if the graph cannot be computed.
pub(crate) fn lower(graph: &Graph) -> Result<Program, Error> {
    validate(graph)?;
    let homes = Homes::of(graph);
    let mut program = Program::default();
    // The activation of each value that is not part of another.
    let mut activations = vec![None; graph.nodes.len()];
    let mut slot = |program: &mut Program, value: Value| {
        let (root, first) = homes.place(value.0);
        let activation = *activations[root].get_or_insert_with(|| {
            program.channels.push(graph.channels(Value(root)));
            program.channels.len() - 1
        });
        Slot { activation, first, count: graph.channels(value) }
    };
    for (at, node) in graph.nodes.iter().enumerate() {
        let output = slot(&mut program, Value(at));
        match node {
            Node::Input(frames) => program.inputs.push((output, *frames)),
            Node::Convolution { layer, input, shortcut } => {
                let input = slot(&mut program, *input);
                if let Some(shortcut) = *shortcut {
                    let shortcut = slot(&mut program, shortcut);
                    if shortcut != output {
                        program.steps.push(Step::Copy { input: shortcut, output });
                    }
                }
                let convolution = layer.clone();
                program.layers.push(Layer { convolution, inputs: input.count });
                let layer = program.layers.len() - 1;
                let add = shortcut.is_some();
                program.steps.push(Step::Convolution { layer, input, output, add });
            }
            Node::MaxPool { window, input } => {
                let input = slot(&mut program, *input);
                program.steps.push(Step::MaxPool { window: *window, input, output });
            }
            Node::Resize { size, alignment, input } => {
                let input = slot(&mut program, *input);
                let (size, alignment) = (*size, *alignment);
                program.steps.push(Step::Resize { size, alignment, input, output });
            }
            Node::Reshape { size, input } => {
                let input = slot(&mut program, *input);
                program.steps.push(Step::Reshape { size: *size, input, output });
            }
            Node::Concatenation { parts } => {
                let mut first = output.first;
                for &part in parts {
                    let input = slot(&mut program, part);
                    let output = Slot { first, count: input.count, ..output };
                    if input != output {
                        program.steps.push(Step::Copy { input, output });
                    }
                    first += input.count;
                }
            }
        }
    }
    for &value in &graph.outputs {
        let slot = slot(&mut program, value);
        program.outputs.push(slot);
    }
    if let Some(Head { pooled, classifier }) = &graph.head {
        let pooled =
            pooled.iter().map(|&(value, pooling)| (slot(&mut program, value), pooling)).collect();
        program.classifier = Some(Classifier { pooled, name: classifier.clone() });
    }
    Ok(program)
}

/// The memory of values: an activation of their own, or some channels of another value.
struct Homes<'a> {
    graph: &'a Graph,
    /// The value that contains a value, and the first channel there.
    within: Vec<Option<(usize, usize)>>,
    /// The last node that reads a value. Outputs have the largest number.
    last_reads: Vec<usize>,
}

impl<'a> Homes<'a> {
    fn of(graph: &'a Graph) -> Self {
        let mut last_reads = vec![0; graph.nodes.len()];
        for (at, node) in graph.nodes.iter().enumerate() {
            for value in reads(node) {
                last_reads[value.0] = at;
            }
        }
        let pooled = graph.head.iter().flat_map(|head| &head.pooled).map(|(value, _)| value);
        for end in graph.outputs.iter().chain(pooled) {
            last_reads[end.0] = usize::MAX;
        }
        let mut homes = Self { graph, within: vec![None; graph.nodes.len()], last_reads };
        for (at, node) in graph.nodes.iter().enumerate() {
            match node {
                Node::Convolution { shortcut: Some(shortcut), .. }
                    if homes.is_free(*shortcut, at) =>
                {
                    homes.try_to_place(*shortcut, at, 0);
                }
                Node::Concatenation { parts } => {
                    let mut first = 0;
                    for &part in parts {
                        homes.try_to_place(part, at, first);
                        first += graph.channels(part);
                    }
                }
                _ => {}
            }
        }
        homes
    }

    /// Returns the value whose activation contains a value, and the first channel there.
    fn place(&self, mut value: usize) -> (usize, usize) {
        let mut first = 0;
        while let Some((home, at)) = self.within[value] {
            value = home;
            first += at;
        }
        (value, first)
    }

    /// Returns true if a node may overwrite a value: no later node reads it or a value in the same
    /// activation.
    fn is_free(&self, value: Value, node: usize) -> bool {
        (0..node).all(|other| self.place(other).0 != value.0 || self.last_reads[other] <= node)
    }

    /// Places a value inside another, if it has no place yet and no step would read and write the
    /// same activation.
    fn try_to_place(&mut self, Value(value): Value, home: usize, first: usize) {
        let is_input = matches!(self.graph.nodes[value], Node::Input(_));
        if is_input || self.within[value].is_some() {
            return;
        }
        self.within[value] = Some((home, first));
        if !self.is_sound() {
            self.within[value] = None;
        }
    }

    /// Returns true if no step reads and writes the same activation.
    fn is_sound(&self) -> bool {
        let root = |value: usize| self.place(value).0;
        // A value in place needs no copy. Any other must come from another activation.
        let can_be_moved =
            |from: usize, to: (usize, usize)| self.place(from) == to || self.place(from).0 != to.0;
        (0..).zip(&self.graph.nodes).all(|(at, node)| match node {
            Node::Input(_) => true,
            Node::MaxPool { input, .. }
            | Node::Resize { input, .. }
            | Node::Reshape { input, .. } => root(input.0) != root(at),
            Node::Convolution { input, shortcut, .. } => {
                root(input.0) != root(at)
                    && shortcut.is_none_or(|shortcut| can_be_moved(shortcut.0, self.place(at)))
            }
            Node::Concatenation { parts } => {
                let (home, mut first) = self.place(at);
                parts.iter().all(|part| {
                    let fits = can_be_moved(part.0, (home, first));
                    first += self.graph.channels(*part);
                    fits
                })
            }
        })
    }
}

/// Returns the values that a node reads.
fn reads(node: &Node) -> Vec<Value> {
    match node {
        Node::Input(_) => Vec::new(),
        Node::Convolution { input, shortcut, .. } => {
            [*input].into_iter().chain(*shortcut).collect()
        }
        Node::MaxPool { input, .. } | Node::Resize { input, .. } | Node::Reshape { input, .. } => {
            vec![*input]
        }
        Node::Concatenation { parts } => parts.clone(),
    }
}
