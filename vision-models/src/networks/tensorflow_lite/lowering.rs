//! Converts the operators of a file to the engine's graph.
//!
//! Operators for which the engine has no layer become convolutions of 1 × 1 that multiply by one.
//! These are a padding that no convolution can include, and a function or an addition by itself.

use std::collections::BTreeMap;

use crate::engine::{Activation, Convolution, Graph};
use crate::error::Error;
use crate::weights::tensorflow_lite::{Constant, Model};
use crate::weights::{Budget, refused};

use super::values::{Known, Shape, Written, Zeros};
use super::weights::{Source, Weight};

/// Largest size of all activations of a network, without sharing of memory (bytes).
const MOST_ACTIVATIONS: usize = 1 << 31;

/// The graph as far as it is built.
#[derive(Debug)]
pub(super) struct Lowering<'a> {
    pub(super) model: Model<'a>,
    /// Memory of the weights, which are read when the network is loaded.
    budget: Budget,
    pub(super) graph: Graph,
    pub(super) weights: BTreeMap<String, Weight>,
    pub(super) input: Shape,
    pub(super) outputs: Vec<Shape>,
    /// Tensors that become outputs, in order.
    ends: Vec<usize>,
    /// The meaning of each tensor that is written.
    written: Vec<Option<Box<Written>>>,
    /// Number of reads of each tensor.
    reads: Vec<usize>,
    /// Bytes of all activations.
    activations: usize,
}

impl<'a> Lowering<'a> {
    /// Begins the graph for some outputs of a file, in this order. All outputs if none are given. The flags are true for
    /// the operators that the outputs need.
    ///
    /// # Errors
    /// [`Error::Checkpoint`] if the file is rejected.
    pub(super) fn begin(file: &'a [u8], kept: &[usize]) -> Result<(Self, Vec<bool>), Error> {
        let model = Model::of(file)?;
        let length = file.len() as u64;
        model.pay(&mut Budget::of_graph(length))?;
        let given = model.inputs()?;
        let [image] = given[..] else {
            let problem = format!("there are {}: networks of one input are read", given.len());
            return Err(refused("inputs", problem));
        };
        let mut reads = vec![0_usize; model.tensors()];
        let mut ends = model.outputs()?;
        if !kept.is_empty() {
            let end = |&index: &usize| ends.get(index).copied();
            let problem = format!("there are {}, and {kept:?} are to be kept", ends.len());
            let found = kept.iter().map(end).collect::<Option<_>>();
            ends = found.ok_or_else(|| refused("outputs", problem))?;
        }
        for &end in &ends {
            reads[end] += 1;
        }
        // Operators that no output needs are left out.
        let mut needed = vec![false; model.operators()];
        for (index, needed) in needed.iter_mut().enumerate().rev() {
            let operator = model.operator(index)?;
            *needed = operator.outputs.iter().any(|&output| reads[output] > 0);
            for tensor in operator.inputs.into_iter().flatten().filter(|_| *needed) {
                reads[tensor] += 1;
            }
        }
        let input = declared(&model, image)?;
        let mut graph = Graph::new();
        let value = graph.input(input.channels);
        let mut lowering = Self {
            model,
            budget: Budget::of_weights(length),
            graph,
            weights: BTreeMap::new(),
            input,
            outputs: Vec::new(),
            ends,
            written: vec![None; reads.len()],
            reads,
            activations: 0,
        };
        lowering.write(image, Written::Activation(Known { value, shape: input }))?;
        Ok((lowering, needed))
    }

    /// Ends the graph with its outputs.
    ///
    /// # Errors
    /// [`Error::Checkpoint`] if no operator has written one of them.
    pub(super) fn finish(mut self) -> Result<Self, Error> {
        for end in std::mem::take(&mut self.ends) {
            let Known { value, shape } = self.activation(end)?;
            self.graph.output(value);
            self.outputs.push(shape);
        }
        Ok(self)
    }

    /// Records what an operator has written, if it agrees with the file.
    pub(super) fn write(&mut self, tensor: usize, written: Written) -> Result<(), Error> {
        let refuse = |model: &Model<'_>, problem: String| Err(refused(model.name(tensor), problem));
        if self.written[tensor].is_some() {
            return refuse(&self.model, "it is written twice".into());
        }
        if let Some(shape) = written.shape() {
            let declared = declared(&self.model, tensor)?;
            if shape != declared {
                let (made, said) = (shape.image(), declared.image());
                let problem = format!(
                    "it comes out as {made:?}, and is said to be {said:?} (channels, rows, columns)"
                );
                return refuse(&self.model, problem);
            }
            let bytes = shape.elements().saturating_mul(size_of::<f32>());
            self.activations = self.activations.saturating_add(bytes);
            if self.activations > MOST_ACTIVATIONS {
                let problem =
                    format!("the activations up to here take more than {MOST_ACTIVATIONS} bytes");
                return refuse(&self.model, problem);
            }
        }
        self.written[tensor] = Some(Box::new(written));
        Ok(())
    }

    /// Returns the meaning of a tensor, if it is written.
    pub(super) fn written(&self, tensor: usize) -> Option<&Written> {
        self.written[tensor].as_deref()
    }

    /// Returns a convolution that only one operator reads and that is not in the graph yet. It may
    /// be joined with that operator.
    pub(super) fn lone_convolution(&self, tensor: usize) -> Option<&Written> {
        let alone = self.reads[tensor] == 1;
        self.written(tensor)
            .filter(|written| alone && matches!(written, Written::Convolution { .. }))
    }

    /// Returns the tensor of the file that holds a tensor's elements, decoded or not. `None` for a
    /// computed one.
    pub(super) fn source(&self, tensor: usize) -> Option<usize> {
        match self.written(tensor) {
            None => Some(tensor),
            Some(Written::Constant(source)) => Some(*source),
            Some(_) => None,
        }
    }

    /// Returns the elements of a tensor in the file. Their memory counts towards the weights' budget.
    ///
    /// # Errors
    /// [`Error::Checkpoint`] if the tensor is computed.
    pub(super) fn constant(&mut self, tensor: usize) -> Result<Constant, Error> {
        let constant = match self.source(tensor) {
            Some(source) => Constant::of(&self.model, source, &mut self.budget)?,
            None => None,
        };
        let problem = "it is computed, where the file has to hold it";
        constant.ok_or_else(|| refused(self.model.name(tensor), problem))
    }

    /// Returns the activation of a tensor, and adds it to the graph if it is not there yet.
    ///
    /// # Errors
    /// [`Error::Checkpoint`] if no previous operator has written the tensor.
    pub(super) fn activation(&mut self, tensor: usize) -> Result<Known, Error> {
        let known = match self.written(tensor).cloned() {
            Some(Written::Activation(known)) => return Ok(known),
            Some(Written::Convolution { layer, input, shape }) => {
                Known { value: self.graph.convolution(input, layer), shape }
            }
            Some(Written::Padded { input, zeros, shape }) => {
                let input = self.activation(input)?;
                self.padded(tensor, input, zeros, shape)?
            }
            Some(Written::Constant(_)) | None => {
                let problem = "it is read as an activation, and no operator before has computed it";
                return Err(refused(self.model.name(tensor), problem));
            }
        };
        self.written[tensor] = Some(Box::new(Written::Activation(known)));
        Ok(known)
    }

    /// Returns the activations of all these tensors.
    ///
    /// # Errors
    /// Those of [`Self::activation`].
    pub(super) fn known(&mut self, tensors: &[Option<usize>]) -> Result<Vec<Known>, Error> {
        tensors.iter().flatten().map(|&tensor| self.activation(tensor)).collect()
    }

    /// Adds a weight. Its memory counts towards the weights' budget.
    pub(super) fn weight(
        &mut self,
        name: String,
        shape: Vec<usize>,
        source: Source,
    ) -> Result<(), Error> {
        let weight = Weight { shape, source };
        if matches!(weight.source, Source::Ones | Source::Ahead(_) | Source::DepthToSpace) {
            self.budget.take(weight.elements().saturating_mul(size_of::<f32>()))?;
        }
        self.weights.insert(name, weight);
        Ok(())
    }

    /// Returns a convolution of 1 × 1 that multiplies every channel by one.
    pub(super) fn identity(
        &mut self,
        name: String,
        channels: usize,
        activation: Activation,
    ) -> Result<Convolution, Error> {
        self.weight(format!("{name}.weight"), vec![channels, 1, 1, 1], Source::Ones)?;
        Ok(Convolution::image(name, channels, [1, 1]).groups(channels).activation(activation))
    }

    /// Adds zeros around an activation.
    fn padded(
        &mut self,
        tensor: usize,
        input: Known,
        [rows, columns, channels]: Zeros,
        shape: Shape,
    ) -> Result<Known, Error> {
        let name = format!("pad.{tensor}");
        let layer = if channels == [0, 0] {
            self.identity(name, shape.channels, Activation::None)?
        } else {
            let (inputs, source) = (input.shape.channels, Source::Ahead(channels[0]));
            self.weight(format!("{name}.weight"), vec![shape.channels, inputs, 1, 1], source)?;
            Convolution::image(name, shape.channels, [1, 1])
        };
        let (padding, extra) = paddings([rows, columns]);
        let layer = layer.padding(padding).extra_padding(extra);
        Ok(Known { value: self.graph.convolution(input.value, layer), shape })
    }
}

/// Returns the engine's padding for zeros before and after rows and columns.
pub(super) fn paddings(zeros: [[usize; 2]; 2]) -> ([usize; 3], [isize; 3]) {
    let [[top, bottom], [left, right]] = zeros;
    let more = |before: usize, after: usize| after.cast_signed() - before.cast_signed();
    ([0, top, left], [0, more(top, bottom), more(left, right)])
}

/// Returns the size of a computed tensor as given in the file.
pub(super) fn declared(model: &Model<'_>, tensor: usize) -> Result<Shape, Error> {
    let head = model.head(tensor)?;
    let refuse = |problem: String| refused(model.name(tensor), problem);
    if head.element != 0 {
        let problem =
            format!("it has elements of type {}: networks compute in float32", head.element);
        return Err(refuse(problem));
    }
    let problem =
        || format!("shape {:?}: give one of at most four axes, for one image", head.shape);
    Shape::of(&head.shape).ok_or_else(|| refuse(problem()))
}
