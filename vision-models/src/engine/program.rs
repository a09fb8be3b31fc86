//! A network as a sequence of steps between activations.

mod fit;
mod parameters;

use crate::kernels::{Alignment, Window};
use crate::layout::Extent;
use crate::weights::TensorSource;

use super::graph::Frames;
use super::head::Pooling;
use super::layer::{Activation, Convolution};
use fit::prefixes;
pub(crate) use fit::{Behind, Fit, Fitted};
use parameters::Expected;
pub(crate) use parameters::Misfit;
pub(super) use parameters::{take, take_where};

/// The channels of an activation that a step reads or writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Slot {
    /// The activation. Several values of a graph may share one.
    pub(crate) activation: usize,
    /// First channel.
    pub(crate) first: usize,
    /// Number of channels.
    pub(crate) count: usize,
}

/// A convolution with the number of channels that it reads.
#[derive(Clone, Debug)]
pub(crate) struct Layer {
    pub(crate) convolution: Convolution,
    pub(crate) inputs: usize,
}

impl Layer {
    /// Returns the number of multiplications and additions for an input and an output of these
    /// sizes.
    pub(crate) fn operations(&self, input: Extent, output: Extent) -> u64 {
        let Convolution { window, outputs, groups, transposed, .. } = &self.convolution;
        // A transposed convolution multiplies every input by every tap.
        let pixels = if *transposed { input } else { output };
        let factors =
            pixels.into_iter().chain(window.kernel).chain([*outputs, self.inputs / groups]);
        factors.fold(2, |product: u64, factor| product.saturating_mul(factor as u64))
    }

    /// Returns the shape of the kernel's tensor.
    pub(crate) fn kernel_shape(&self) -> Vec<usize> {
        let Convolution { window, outputs, groups, transposed, axes, .. } = &self.convolution;
        let (first, second) = if *transposed {
            (self.inputs, outputs / groups)
        } else {
            (*outputs, self.inputs / groups)
        };
        [first, second].into_iter().chain(window.kernel[3 - axes..].iter().copied()).collect()
    }
}

/// One step of the forward pass.
#[derive(Clone, Debug)]
pub(crate) enum Step {
    /// output = activation(layer(input) \[+ output\])
    Convolution { layer: usize, input: Slot, output: Slot, add: bool },
    /// The largest value of each window.
    MaxPool { window: Window, input: Slot, output: Slot },
    /// output = input
    Copy { input: Slot, output: Slot },
    /// Bilinear interpolation to these rows and columns.
    Resize { size: [usize; 2], alignment: Alignment, input: Slot, output: Slot },
    /// The same elements in the same order, as an activation of this size.
    Reshape { size: Extent, input: Slot, output: Slot },
}

impl Step {
    pub(crate) fn input(&self) -> Slot {
        match *self {
            Self::Convolution { input, .. }
            | Self::MaxPool { input, .. }
            | Self::Copy { input, .. }
            | Self::Resize { input, .. }
            | Self::Reshape { input, .. } => input,
        }
    }

    pub(crate) fn output(&self) -> Slot {
        match *self {
            Self::Convolution { output, .. }
            | Self::MaxPool { output, .. }
            | Self::Copy { output, .. }
            | Self::Resize { output, .. }
            | Self::Reshape { output, .. } => output,
        }
    }

    /// Returns the step's name for errors.
    pub(crate) fn name(&self, layers: &[Layer]) -> String {
        match *self {
            Self::Convolution { layer, .. } => layers[layer].convolution.name.clone(),
            Self::MaxPool { .. } => "max pool".into(),
            Self::Copy { .. } => "concatenation".into(),
            Self::Resize { .. } => "resize".into(),
            Self::Reshape { .. } => "reshape".into(),
        }
    }

    /// Returns the size of the output for an input's, or `None` if a kernel does not fit.
    pub(crate) fn size(&self, layers: &[Layer], size: Extent) -> Option<Extent> {
        match *self {
            Self::Convolution { layer, .. } => layers[layer].convolution.output(size),
            Self::MaxPool { window, .. } => window.output(size),
            Self::Copy { .. } => Some(size),
            Self::Resize { size: [rows, columns], .. } => Some([size[0], rows, columns]),
            Self::Reshape { size, .. } => Some(size),
        }
    }

    /// Returns true if the step reads several frames at once.
    fn is_temporal(&self, layers: &[Layer]) -> bool {
        match *self {
            Self::Convolution { layer, .. } => layers[layer].convolution.window.kernel[0] > 1,
            Self::MaxPool { window, .. } => window.kernel[0] > 1,
            Self::Copy { .. } | Self::Resize { .. } => false,
            Self::Reshape { .. } => true,
        }
    }
}

/// The linear layer after the features.
#[derive(Clone, Debug)]
pub(crate) struct Classifier {
    /// The pooled parts.
    pub(crate) pooled: Vec<(Slot, Pooling)>,
    /// The name of the layer.
    pub(crate) name: String,
}

impl Classifier {
    /// Returns the number of features.
    pub(crate) fn features(&self) -> usize {
        self.pooled.iter().map(|(slot, _)| slot.count).sum()
    }

    /// Returns the layer's name in this checkpoint and its number of classes, or `None` if the
    /// checkpoint lacks it.
    pub(crate) fn find(&self, tensors: Behind<'_>) -> Option<(String, usize)> {
        let prefix = format!("{}.", self.name);
        let behind_dropout = format!("{}.1", self.name);
        let classes = |name: &str| {
            let shape = tensors.shape(&format!("{name}.weight"));
            // A layer of no classes has the wrong shape.
            shape
                .and_then(|shape| shape.first().copied())
                .filter(|&classes| classes > 0)
                .unwrap_or(1)
        };
        if tensors.shape(&format!("{behind_dropout}.weight")).is_some() {
            return Some((behind_dropout.clone(), classes(&behind_dropout)));
        }
        let is_there = tensors.names().any(|name| name.starts_with(&prefix));
        is_there.then(|| (self.name.clone(), classes(&self.name)))
    }
}

/// A network, ready to be planned.
#[derive(Clone, Debug, Default)]
pub(crate) struct Program {
    /// The number of channels of each activation.
    pub(crate) channels: Vec<usize>,
    pub(crate) layers: Vec<Layer>,
    pub(crate) steps: Vec<Step>,
    pub(crate) inputs: Vec<(Slot, Frames)>,
    pub(crate) outputs: Vec<Slot>,
    pub(crate) classifier: Option<Classifier>,
}

impl Program {
    /// Returns the tensors of the layers.
    fn expected_layers(&self) -> Expected {
        let mut expected = Expected::default();
        for layer in &self.layers {
            expected.convolution(layer);
        }
        expected
    }

    /// Returns the tensors of a checkpoint with this many classes.
    pub(crate) fn expected(&self, classes: usize) -> Expected {
        let mut expected = self.expected_layers();
        if let Some(classifier) = &self.classifier {
            expected.linear(&classifier.name, classifier.features(), classes);
        }
        expected
    }

    /// Finds this network's tensors in a checkpoint. All of them have the same prefix, which is
    /// mostly empty.
    ///
    /// # Errors
    /// The misfit of the prefix that fits best.
    pub(crate) fn fit(&self, tensors: &dyn TensorSource) -> Result<Fit, Misfit> {
        let layers = self.expected_layers();
        let mut least: Option<Misfit> = None;
        for prefix in prefixes(tensors, layers.first().unwrap_or_default()) {
            let behind = Behind::new(tensors, &prefix);
            let mut expected = layers.clone();
            if let Some(classifier) = &self.classifier
                && let Some((name, classes)) = classifier.find(behind)
            {
                expected.linear(&name, classifier.features(), classes);
            }
            match expected.check(behind) {
                Ok(left_out) => return Ok(Fit { prefix, left_out }),
                Err(misfit) => {
                    least = Some(match least.take() {
                        Some(least) => least.or_smaller(misfit),
                        None => misfit,
                    });
                }
            }
        }
        Err(least.unwrap_or_default())
    }

    /// Returns frames, rows and columns of each input for a clip of this size.
    pub(crate) fn input_sizes(&self, [frames, rows, columns]: Extent) -> Vec<(Slot, Extent)> {
        let size = |&(slot, taken): &(Slot, Frames)| (slot, [taken.taken(frames), rows, columns]);
        self.inputs.iter().map(size).collect()
    }

    /// Returns the activations that are still needed after the last step.
    pub(crate) fn ends(&self) -> Vec<Slot> {
        let pooled = self.classifier.iter().flat_map(|classifier| &classifier.pooled);
        self.outputs.iter().copied().chain(pooled.map(|&(slot, _)| slot)).collect()
    }

    /// Returns the input and the index of the first step whose kernel reads several frames. Before
    /// it, each frame is computed alone.
    pub(crate) fn first_temporal_step(&self) -> Option<(Slot, usize)> {
        let at = self.steps.iter().position(|step| step.is_temporal(&self.layers))?;
        Some((self.steps[at].input(), at))
    }
}

/// Returns the name of an activation's slopes and whether they are shared, if it has any.
pub(crate) fn slopes(activation: &Activation) -> Option<(String, bool)> {
    match activation {
        Activation::Prelu { name, shared } => Some((format!("{name}.weight"), *shared)),
        Activation::None | Activation::Relu | Activation::Relu6 | Activation::Logistic => None,
    }
}
