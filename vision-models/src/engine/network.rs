//! A network with its weights and threads.

use ndarray::{ArrayView2, ArrayView5};

use crate::error::Error;
use crate::layout::Extent;
use crate::weights::TensorSource;

use super::graph::Graph;
use super::input::{overflow, wrong_input};
use super::lowering::lower;
use super::options::Options;
use super::packed::Packed;
use super::program::{Behind, Classifier, Fitted, Misfit, Program, Slot, Step};
use super::scores::Scores;
use super::session::{Session, Weights, copy_clip, copy_map};
use super::shapes::{Algorithm, sizes};
use super::threads::{ThreadSettings, Threads};

/// A network that runs: a graph with packed weights, and planned passes for some input sizes.
///
/// ```
/// use ndarray::Array5;
/// use vision_models::engine::{Activation::Relu, Convolution, Graph, Network, Pooling};
/// use vision_models::{Options, Tensor, Tensors};
///
/// let mut graph = Graph::new();
/// let image = graph.input(3);
/// let edges = Convolution::image("edges", 8, [3, 3]).stride([1, 2, 2]).bias().activation(Relu);
/// let x = graph.convolution(image, edges);
/// graph.output(x);
/// graph.classify(&[(x, Pooling::Mean)], "classifier");
///
/// let mut weights = Tensors::new();
/// for (name, shape) in Network::parameters(&graph, 2)? {
///     let elements = vec![0.01; shape.iter().product()];
///     weights.insert(name, Tensor::new(shape, elements)?)?;
/// }
/// let mut network = Network::load(&graph, weights, [1, 32, 48], Options::default())?;
/// let image = Array5::ones((1, 3, 1, 32, 48));
/// let inference = network.infer(image.view())?;
/// assert_eq!(inference.map(0).map(|map| map.dim()), Some((1, 8, 1, 16, 24)));
/// assert_eq!(inference.scores().logits.dim(), (1, 2));
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Debug)]
pub struct Network {
    pub(crate) program: Program,
    pub(crate) weights: Weights,
    pub(crate) options: Options,
    pub(crate) threads: Threads,
    /// The planned passes by input size.
    planned: Vec<(Extent, Session)>,
    /// The pass for the last size that was not planned in advance.
    unplanned: Option<(Extent, Session)>,
    operations: u64,
    features: Vec<f32>,
    logits: Vec<f32>,
    maps: Vec<Map>,
}

/// One output of a batch, channels innermost.
#[derive(Debug, Default)]
struct Map {
    size: Extent,
    channels: usize,
    data: Vec<f32>,
}

impl Network {
    /// Returns the names and shapes of the tensors that a checkpoint with this many classes must
    /// hold. In a network without a head the number of classes does not matter.
    ///
    /// # Errors
    /// [`Error::Layer`] if the graph cannot be computed.
    pub fn parameters(graph: &Graph, classes: usize) -> Result<Vec<(String, Vec<usize>)>, Error> {
        Ok(lower(graph)?.expected(classes).into_tensors())
    }

    /// Loads a network: packs the weights of a checkpoint for inputs of this size (frames, rows,
    /// columns) and plans the pass. [`NetworkKind::of`](crate::NetworkKind::of) tells which network
    /// a checkpoint holds.
    ///
    /// # Errors
    /// - [`Error::Layer`] if the graph cannot be computed.
    /// - [`Error::Weights`] with every tensor that is missing, surplus or of the wrong shape.
    /// - [`Error::Value`] if a weight is not finite or a variance is negative.
    /// - [`Error::Overflow`] if a weight is too large for f32.
    /// - [`Error::Size`] if the size does not fit.
    /// - [`Error::Threads`] if this number of threads cannot be started.
    pub fn load(
        graph: &Graph,
        tensors: impl TensorSource,
        size: [usize; 3],
        options: Options,
    ) -> Result<Self, Error> {
        let program = lower(graph)?;
        let misfit = |Misfit { missing, surplus, misshapen }| Error::Weights {
            network: None,
            found: None,
            missing,
            surplus,
            misshapen,
        };
        let fit = program.fit(&tensors).map_err(misfit)?;
        let tensors = Box::new(Fitted::new(Box::new(tensors), fit));
        Self::of_program(program, tensors, size, options)
    }

    /// Loads tensors that the program has checked. It is compiled once for all sources of tensors.
    pub(crate) fn of_program(
        program: Program,
        mut tensors: Box<dyn TensorSource + '_>,
        size: Extent,
        options: Options,
    ) -> Result<Self, Error> {
        options.validate()?;
        let isa = options.instruction_set;
        let inputs = program.input_sizes(size);
        let sizes = sizes(&program, &program.steps, &inputs)?;
        let of = |slot: Slot| sizes[slot.activation].unwrap_or_default();
        let mut operations = 0_u64;
        let mut layers = Vec::with_capacity(program.layers.len());
        for step in &program.steps {
            let Step::Convolution { layer, input, output, .. } = *step else { continue };
            let layer = &program.layers[layer];
            let algorithm = Algorithm::choose(layer, of(output));
            layers.push(Packed::convolution(isa, layer, algorithm, &mut *tensors)?);
            operations = operations.saturating_add(layer.operations(of(input), of(output)));
        }
        let mut classifier = None;
        if let Some(head) = &program.classifier
            && let Some((name, classes)) = head.find(Behind::new(&*tensors, ""))
        {
            let features = head.features();
            classifier = Some(Packed::linear(isa, &name, features, classes, &mut *tensors)?);
            operations = operations.saturating_add(2 * (features * classes) as u64);
        }
        drop(tensors);
        let settings = ThreadSettings { threads: options.threads, ..ThreadSettings::default() };
        let maps = program.outputs.iter().map(|_| Map::default()).collect();
        let mut network = Self {
            program,
            weights: Weights { layers, classifier },
            options,
            threads: Threads::new(&settings)?,
            planned: Vec::new(),
            unplanned: None,
            operations,
            features: Vec::new(),
            logits: Vec::new(),
            maps,
        };
        network.plan(size)?;
        Ok(network)
    }

    /// Plans the pass for another size (frames, rows, columns) and keeps it beside those planned
    /// before.
    ///
    /// An inference of a size that was not planned plans it, and keeps it until an inference of
    /// another such size. Weights stay packed for the size given at loading.
    ///
    /// # Errors
    /// - [`Error::Size`] if the kernels, the head's windows or the memory do not fit.
    /// - [`Error::Layer`] if joined activations have different sizes.
    pub fn plan(&mut self, size: [usize; 3]) -> Result<(), Error> {
        if self.planned.iter().all(|(planned, _)| *planned != size) {
            let session = self.session(&self.program.steps, &self.program.input_sizes(size))?;
            self.planned.push((size, session));
        }
        Ok(())
    }

    /// Makes the network run on other threads, which networks may share. All sizes are planned
    /// again.
    ///
    /// # Errors
    /// Those of [`Self::plan`].
    pub fn share_threads(&mut self, threads: &Threads) -> Result<(), Error> {
        self.threads = threads.clone();
        self.unplanned = None;
        for (size, _) in std::mem::take(&mut self.planned) {
            self.plan(size)?;
        }
        Ok(())
    }

    /// Returns the number of multiplications and additions for one input of the size given at
    /// loading.
    pub fn operations(&self) -> u64 {
        self.operations
    }

    /// Returns the number of classes, which is the width of the logits. 0 for a checkpoint without
    /// a head.
    pub fn classes(&self) -> usize {
        self.weights.classifier.as_ref().map_or(0, |classifier| classifier.panels.outputs())
    }

    /// Returns the width of the features, which the last layer reads. 0 for a network without a
    /// head.
    pub fn features(&self) -> usize {
        self.program.classifier.as_ref().map_or(0, Classifier::features)
    }

    /// Plans the steps from `inputs` to the ends.
    pub(crate) fn session(
        &self,
        steps: &[Step],
        inputs: &[(Slot, Extent)],
    ) -> Result<Session, Error> {
        let isa = self.options.instruction_set;
        Session::new(isa, self.threads.count(), &self.program, &self.weights, steps, inputs)
    }

    /// Runs the network on a batch, N × channels × frames × rows × columns.
    ///
    /// # Errors
    /// - [`Error::Size`] if there are no inputs or the channels are not the graph's.
    /// - Those of [`Self::plan`] for a new size.
    /// - [`Error::Value`] if a value is NaN or infinite.
    /// - [`Error::Overflow`] if an output is NaN or infinite.
    pub fn infer(&mut self, clips: ArrayView5<'_, f32>) -> Result<Inference<'_>, Error> {
        let (count, channels, frames, rows, columns) = clips.dim();
        let size = [frames, rows, columns];
        let expected = self.program.inputs.first().map_or(0, |(slot, _)| slot.count);
        if channels != expected || count == 0 {
            return Err(wrong_input(clips.shape()));
        }
        let is_planned = self.planned.iter().any(|(planned, _)| *planned == size);
        if !is_planned && self.unplanned.as_ref().is_none_or(|(planned, _)| *planned != size) {
            // The memory of the previous size is released first.
            self.unplanned = None;
            let session = self.session(&self.program.steps, &self.program.input_sizes(size))?;
            self.unplanned = Some((size, session));
        }
        let (features, classes) = (self.features(), self.classes());
        self.features.resize(count * features, 0.0);
        self.logits.resize(count * classes, 0.0);
        let Self { program, weights, threads, planned, unplanned, maps, .. } = self;
        let sessions = planned.iter_mut().chain(unplanned);
        let session =
            sessions.map(|(planned, session)| (*planned, session)).find(|(own, _)| *own == size);
        let Some((_, session)) = session else {
            return Err(wrong_input(clips.shape()));
        };
        for (map, (channels, _)) in maps.iter_mut().zip(session.maps()) {
            (map.size, map.channels) = (channels.layout.size, channels.count);
            map.data.resize(count * channels.layout.pixels() * channels.count, 0.0);
        }
        let mut pool = threads.lock();
        for (index, clip) in clips.outer_iter().enumerate() {
            for (input, &(_, frames)) in program.inputs.iter().enumerate() {
                copy_clip(&clip, index, frames, session.plan.input(input))?;
            }
            let features = &mut self.features[index * features..][..features];
            let logits = &mut self.logits[index * classes..][..classes];
            session.run(&mut pool, weights, features, logits);
            check_finite(index, features, logits)?;
            for (map, output) in maps.iter_mut().zip(session.maps()) {
                let length = map.data.len() / count;
                if !copy_map(output, &mut map.data[index * length..][..length]) {
                    return Err(overflow(index));
                }
            }
        }
        drop(pool);
        let view = |width, data| {
            ArrayView2::from_shape((count, width), data).map_err(|_| wrong_input(clips.shape()))
        };
        let scores = Scores {
            logits: view(classes, &self.logits)?,
            features: view(features, &self.features)?,
        };
        Ok(Inference { scores, maps: &self.maps, count })
    }
}

/// Checks that an input's features and scores are finite. The kernels turn an overflow into NaN,
/// and every value that depends on it is NaN or infinite.
///
/// # Errors
/// [`Error::Overflow`].
pub(crate) fn check_finite(input: usize, features: &[f32], logits: &[f32]) -> Result<(), Error> {
    if features.iter().chain(logits).all(|value| value.is_finite()) {
        Ok(())
    } else {
        Err(overflow(input))
    }
}

/// The output of a network for a batch.
#[derive(Clone, Copy, Debug)]
pub struct Inference<'a> {
    scores: Scores<'a>,
    maps: &'a [Map],
    /// Number of inputs of the batch.
    count: usize,
}

impl<'a> Inference<'a> {
    /// Returns features and class scores. They are N × 0 arrays if the network or the checkpoint
    /// has no head.
    pub fn scores(&self) -> Scores<'a> {
        self.scores
    }

    /// Returns the `index`-th output of the graph, N × channels × frames × rows × columns, or
    /// `None` if there are fewer. Channels run fastest in memory.
    pub fn map(&self, index: usize) -> Option<ArrayView5<'a, f32>> {
        let Map { size: [frames, rows, columns], channels, data } = self.maps.get(index)?;
        let shape = (self.count, *frames, *rows, *columns, *channels);
        let map = ArrayView5::from_shape(shape, data).ok()?;
        Some(map.permuted_axes([0, 4, 1, 2, 3]))
    }
}
