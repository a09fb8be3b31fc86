//! A network with its weights and threads: what all architectures have in common.

use ndarray::{ArrayView2, ArrayView4, ArrayView5, Axis};

use crate::kernels::{InstructionSet, Pool};
use crate::layout::Extent;
use crate::{Error, TensorSource};

use super::graph::{Architecture, Step};
use super::kind::NetworkKind;
use super::parameters::{Misfit, Packed};
use super::session::{Session, Weights, copy_clip};
use super::shapes::{Algorithm, sizes};

/// How a network runs.
///
/// ```
/// use vision_models::Options;
///
/// let options = Options { threads: 2, ..Options::default() };
/// assert!(!options.instruction_set.name().is_empty());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Threads that share the work, the caller's included: from 1 to [`Self::MAX_THREADS`]. The
    /// results are the same for any number.
    pub threads: usize,
    /// The instruction set of the kernels.
    pub instruction_set: InstructionSet,
}

impl Options {
    /// The most threads, more than any processor runs at once.
    pub const MAX_THREADS: usize = 1024;

    /// Checks every setting.
    ///
    /// # Errors
    /// [`Error::Threads`] for none or more than [`Self::MAX_THREADS`].
    pub fn validate(&self) -> Result<(), Error> {
        if (1..=Self::MAX_THREADS).contains(&self.threads) {
            return Ok(());
        }
        let reason = format!("give from 1 to {}", Self::MAX_THREADS);
        Err(Error::Threads { threads: self.threads, reason })
    }
}

impl Default for Options {
    /// One thread, and the fastest instruction set that the processor has.
    fn default() -> Self {
        Self { threads: 1, instruction_set: InstructionSet::detect() }
    }
}

/// What a network says about each input of a batch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scores<'a> {
    /// N × classes: the scores before any softmax.
    pub logits: ArrayView2<'a, f32>,
    /// N × features: what the linear layer sees.
    pub features: ArrayView2<'a, f32>,
}

/// A batch of clips, N × 3 × frames × height × width.
pub(crate) struct Clips<'a>(ArrayView5<'a, f32>);

impl<'a> Clips<'a> {
    pub(crate) fn new(clips: ArrayView5<'a, f32>) -> Self {
        Self(clips)
    }

    /// Images are clips of one frame.
    pub(crate) fn from_images(images: ArrayView4<'a, f32>) -> Self {
        Self(images.insert_axis(Axis(2)))
    }
}

/// Whether an input's features and scores are numbers. The kernels make NaN of what overflows, and
/// whatever depends on it is NaN or infinite.
///
/// # Errors
/// [`Error::Overflow`].
pub(crate) fn check_finite(input: usize, features: &[f32], logits: &[f32]) -> Result<(), Error> {
    if features.iter().chain(logits).all(|value| value.is_finite()) {
        Ok(())
    } else {
        Err(Error::Overflow { input })
    }
}

#[derive(Debug)]
pub(crate) struct Network {
    pub(crate) architecture: Architecture,
    pub(crate) weights: Weights,
    pub(crate) options: Options,
    pub(crate) threads: Pool,
    /// The forward pass for the size of the last clips.
    session: Option<(Extent, Session)>,
    operations: u64,
    features: Vec<f32>,
    logits: Vec<f32>,
}

impl Network {
    /// Compiled once for all sources of tensors.
    pub(crate) fn load(
        kind: NetworkKind,
        mut tensors: Box<dyn TensorSource + '_>,
        size: Extent,
        options: Options,
    ) -> Result<Self, Error> {
        options.validate()?;
        let isa = options.instruction_set;
        let architecture = kind.architecture();
        let classes = architecture.check(&*tensors).map_err(|misfit| {
            let Misfit { missing, surplus, misshapen } = misfit;
            let found = NetworkKind::of(&*tensors);
            Error::Weights { network: kind, found, missing, surplus, misshapen }
        })?;
        let Architecture { graph, classifier, .. } = &architecture;
        let features = architecture.features();
        let sizes = sizes(graph, &graph.steps, &architecture.input_sizes(size))?;
        let mut operations = 2 * features * classes;
        let mut layers = Vec::with_capacity(graph.layers.len());
        for step in &graph.steps {
            let Step::Convolution { layer, output, .. } = *step else { continue };
            let layer = &graph.layers[layer];
            let size = sizes[output.0].unwrap_or_default();
            let algorithm = Algorithm::choose(layer, size);
            layers.push(Packed::convolution(isa, layer, algorithm, &mut *tensors)?);
            operations += layer.operations(size);
        }
        let classifier = Packed::linear(isa, classifier, features, classes, &mut *tensors)?;
        drop(tensors);
        let threads = Pool::new(options.threads).map_err(|error| Error::Threads {
            threads: options.threads,
            reason: error.to_string(),
        })?;
        Ok(Self {
            weights: Weights { layers, classifier },
            architecture,
            options,
            threads,
            session: None,
            operations: operations as u64,
            features: Vec::new(),
            logits: Vec::new(),
        })
    }

    pub(crate) fn operations(&self) -> u64 {
        self.operations
    }

    pub(crate) fn classes(&self) -> usize {
        self.weights.classifier.panels.channels
    }

    pub(crate) fn features(&self) -> usize {
        self.architecture.features()
    }

    /// Plans the steps from `inputs` to the scores.
    pub(crate) fn plan(
        &self,
        steps: &[Step],
        inputs: &[(super::graph::Value, Extent)],
    ) -> Result<Session, Error> {
        let Options { instruction_set, threads } = self.options;
        Session::new(instruction_set, threads, &self.architecture, &self.weights, steps, inputs)
    }

    pub(crate) fn infer(&mut self, Clips(clips): &Clips<'_>) -> Result<Scores<'_>, Error> {
        let (count, channels, frames, rows, columns) = clips.dim();
        let size = [frames, rows, columns];
        let shape = || Error::InputShape { shape: clips.shape().to_vec() };
        if channels != 3 || count == 0 {
            return Err(shape());
        }
        let planned = self.session.take_if(|(planned, _)| *planned == size);
        let planned = if let Some(planned) = planned {
            planned
        } else {
            let inputs = self.architecture.input_sizes(size);
            (size, self.plan(&self.architecture.graph.steps, &inputs)?)
        };
        let (_, session) = self.session.insert(planned);
        let features = self.architecture.features();
        let classes = self.weights.classifier.panels.channels;
        self.features.resize(count * features, 0.0);
        self.logits.resize(count * classes, 0.0);
        let scores =
            self.features.chunks_exact_mut(features).zip(self.logits.chunks_exact_mut(classes));
        for ((index, clip), (features, logits)) in clips.outer_iter().enumerate().zip(scores) {
            for input in 0..self.architecture.inputs.len() {
                copy_clip(&clip, index, session.plan.input(input))?;
            }
            session.run(&mut self.threads, &self.weights, features, logits);
            check_finite(index, features, logits)?;
        }
        let view = |width, data| ArrayView2::from_shape((count, width), data).map_err(|_| shape());
        Ok(Scores {
            logits: view(classes, &self.logits)?,
            features: view(features, &self.features)?,
        })
    }
}
