//! From a checkpoint's tensors to packed weights.

use crate::kernels::{Buffer, InstructionSet, Panels, Winograd, pack};
use crate::{Error, TensorSource};

use super::graph::Layer;
use super::shapes::Algorithm;

/// PyTorch's default, which all of these networks were trained with.
const NORM_EPSILON: f64 = 1e-5;

/// The tensors that a network takes from a checkpoint.
#[derive(Clone, Debug, Default)]
pub(crate) struct Expected {
    tensors: Vec<(String, Vec<usize>)>,
    optional: Vec<String>,
}

/// Everything that makes a checkpoint another network's; see [`Error::Weights`].
#[derive(Clone, Debug)]
pub(crate) struct Misfit {
    pub(crate) missing: Vec<String>,
    pub(crate) surplus: Vec<String>,
    pub(crate) misshapen: Vec<String>,
}

impl Expected {
    pub(crate) fn convolution(&mut self, layer: &Layer) {
        self.tensors.push((format!("{}.weight", layer.names.convolution), kernel_shape(layer)));
        for part in ["weight", "bias", "running_mean", "running_var"] {
            self.tensors.push((format!("{}.{part}", layer.names.norm), vec![layer.outputs]));
        }
        self.optional.push(format!("{}.num_batches_tracked", layer.names.norm));
    }

    pub(crate) fn linear(&mut self, name: &str, inputs: usize, outputs: usize) {
        self.tensors.push((format!("{name}.weight"), vec![outputs, inputs]));
        self.tensors.push((format!("{name}.bias"), vec![outputs]));
    }

    /// The names and shapes of the tensors that there must be.
    pub(crate) fn into_tensors(self) -> Vec<(String, Vec<usize>)> {
        self.tensors
    }

    /// Holds a checkpoint against what is expected.
    pub(crate) fn check(&self, tensors: &dyn TensorSource) -> Result<(), Misfit> {
        let mut missing = Vec::new();
        let mut misshapen = Vec::new();
        let mut known =
            self.optional.iter().map(String::as_str).collect::<std::collections::BTreeSet<_>>();
        for (name, shape) in &self.tensors {
            known.insert(name);
            match tensors.shape(name) {
                None => missing.push(format!("{name} {shape:?}")),
                Some(found) if found != shape.as_slice() => {
                    misshapen.push(format!("{name} {found:?} instead of {shape:?}"));
                }
                Some(_) => {}
            }
        }
        let surplus: Vec<_> = tensors
            .names()
            .into_iter()
            .filter(|name| !known.contains(name))
            .map(String::from)
            .collect();
        if missing.is_empty() && surplus.is_empty() && misshapen.is_empty() {
            Ok(())
        } else {
            Err(Misfit { missing, surplus, misshapen })
        }
    }
}

fn kernel_shape(layer: &Layer) -> Vec<usize> {
    let kernel = &layer.window.kernel[3 - layer.axes..];
    [layer.outputs, layer.inputs].iter().chain(kernel).copied().collect()
}

/// The elements of a tensor that [`Expected::check`] has seen, all of them finite.
fn take(tensors: &mut dyn TensorSource, name: &str) -> Result<Vec<f32>, Error> {
    take_where(tensors, name, f32::is_finite, "a finite number")
}

/// The elements of a tensor, if `is_right` says so of each.
fn take_where(
    tensors: &mut dyn TensorSource,
    name: &str,
    is_right: impl Fn(f32) -> bool,
    expected: &'static str,
) -> Result<Vec<f32>, Error> {
    let promised = tensors.shape(name).map(<[usize]>::to_vec).unwrap_or_default();
    let tensor = tensors.take(name)?;
    if tensor.shape() != promised {
        return Err(Error::TensorSize { shape: promised, elements: tensor.data().len() });
    }
    // Nearly always all are right, and a fold over all is faster than a search.
    let all = tensor.data().iter().fold(true, |all, &value| all & is_right(value));
    if !all && let Some(at) = tensor.data().iter().position(|&value| !is_right(value)) {
        let (name, value) = (name.to_owned(), tensor.data()[at]);
        return Err(Error::Weight { name, index: index_of(at, &promised), value, expected });
    }
    Ok(tensor.into_data())
}

/// The index along each axis of the `at`-th element in C order.
fn index_of(mut at: usize, shape: &[usize]) -> Vec<usize> {
    let mut index = vec![0; shape.len()];
    for (place, &axis) in index.iter_mut().zip(shape).rev() {
        *place = at % axis;
        at /= axis;
    }
    index
}

/// A layer ready to run.
#[derive(Clone, Debug)]
pub(crate) struct Packed {
    pub(crate) algorithm: Algorithm,
    pub(crate) panels: Panels,
    pub(crate) weights: Buffer,
    /// One for each channel of the panels.
    pub(crate) bias: Vec<f32>,
}

#[expect(clippy::cast_possible_truncation, reason = "the weights are f32")]
fn narrow(value: f64) -> f32 {
    value as f32
}

impl Packed {
    /// Takes a layer's tensors out of the checkpoint, folds the batch norm (in f64) and packs.
    ///
    /// # Errors
    /// [`Error::Weight`], [`Error::FoldedWeights`], and what the source gives.
    pub(crate) fn convolution(
        isa: InstructionSet,
        layer: &Layer,
        algorithm: Algorithm,
        tensors: &mut dyn TensorSource,
    ) -> Result<Self, Error> {
        let kernel = take(tensors, &format!("{}.weight", layer.names.convolution))?;
        let mut norm = |part| take(tensors, &format!("{}.{part}", layer.names.norm));
        let (gain, shift, mean) = (norm("weight")?, norm("bias")?, norm("running_mean")?);
        let variance = take_where(
            tensors,
            &format!("{}.running_var", layer.names.norm),
            |value| value.is_finite() && value >= 0.0,
            "a finite number, zero or more: a variance",
        )?;
        let scale: Vec<f64> = gain
            .iter()
            .zip(&variance)
            .map(|(&gain, &variance)| f64::from(gain) / (f64::from(variance) + NORM_EPSILON).sqrt())
            .collect();
        let panels = Panels::new(isa, layer.outputs);
        let mut bias = vec![0.0; panels.padded()];
        for (channel, bias) in bias.iter_mut().enumerate().take(layer.outputs) {
            *bias = narrow(f64::from(shift[channel]) - f64::from(mean[channel]) * scale[channel]);
        }
        let taps: usize = layer.window.kernel.iter().product();
        let inputs = layer.inputs;
        let weights = match algorithm {
            Algorithm::Direct => pack(panels, taps * inputs, |output, column| {
                let kernel = &kernel[output * inputs * taps..][..inputs * taps];
                for (input, kernel) in kernel.chunks_exact(taps).enumerate() {
                    for (tap, &weight) in kernel.iter().enumerate() {
                        column[tap * inputs + input] = narrow(f64::from(weight) * scale[output]);
                    }
                }
            }),
            Algorithm::Winograd(tiling) => {
                Winograd::pack(panels, tiling, inputs, |output, input, values| {
                    let kernel = &kernel[(output * inputs + input) * taps..][..taps];
                    for (value, &weight) in values.iter_mut().zip(kernel) {
                        *value = f64::from(weight) * scale[output];
                    }
                })
            }
        };
        let is_finite = |values: &[f32]| values.iter().fold(true, |all, v| all & v.is_finite());
        if !is_finite(&weights) || !is_finite(&bias) {
            return Err(Error::FoldedWeights { layer: layer.names.convolution.clone() });
        }
        Ok(Self { algorithm, panels, weights, bias })
    }

    /// Takes a linear layer's tensors out of the checkpoint and packs them.
    pub(crate) fn linear(
        isa: InstructionSet,
        name: &str,
        inputs: usize,
        outputs: usize,
        tensors: &mut dyn TensorSource,
    ) -> Result<Self, Error> {
        let matrix = take(tensors, &format!("{name}.weight"))?;
        let mut bias = take(tensors, &format!("{name}.bias"))?;
        let panels = Panels::new(isa, outputs);
        bias.resize(panels.padded(), 0.0);
        let weights = pack(panels, inputs, |output, column| {
            column.copy_from_slice(&matrix[output * inputs..][..inputs]);
        });
        Ok(Self { algorithm: Algorithm::Direct, panels, weights, bias })
    }
}
