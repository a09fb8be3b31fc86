//! Weights in the order in which the kernels read them.

use crate::error::Error;
use crate::excerpt::Excerpt;
use crate::kernels::{Buffer, Finish, InstructionSet, Operands, Panels, Phase, Winograd, pack};
use crate::weights::TensorSource;

use super::layer::{Activation, Convolution};
use super::program::{Layer, slopes, take, take_where};
use super::shapes::Algorithm;

/// Width of the narrowest panel. Groups with fewer outputs are computed together.
const NARROWEST: usize = 16;

/// A layer ready to run.
#[derive(Clone, Debug)]
pub(crate) struct Packed {
    pub(crate) algorithm: Algorithm,
    pub(crate) panels: Panels,
    /// Weights of each phase.
    weights: Vec<Buffer>,
    /// Bias of each channel of the panels.
    bias: Vec<f32>,
    activation: PackedActivation,
}

#[derive(Clone, Debug)]
enum PackedActivation {
    None,
    Relu,
    Relu6,
    Logistic,
    /// Slope of each channel of the panels.
    Prelu(Vec<f32>),
}

impl Packed {
    /// Packs a convolution's tensors from the checkpoint. The batch norm is folded in f64.
    ///
    /// # Errors
    /// [`Error::Value`], [`Error::Overflow`], and the errors of the source.
    pub(crate) fn convolution(
        isa: InstructionSet,
        layer: &Layer,
        algorithm: Algorithm,
        tensors: &mut dyn TensorSource,
    ) -> Result<Self, Error> {
        let Convolution { name, outputs, .. } = &layer.convolution;
        let kernel = take(tensors, &format!("{name}.weight"))?;
        let Affine { scale, shift } = Affine::of(&layer.convolution, tensors)?;
        let kernel = Kernel { layer, elements: kernel, scale };
        let panels = match algorithm {
            Algorithm::Depthwise => Panels { groups: 1, channels: *outputs, width: *outputs },
            Algorithm::Winograd(_) => Panels::whole(isa, *outputs),
            Algorithm::Direct => {
                let groups = layer.convolution.groups / kernel.groups_together();
                Panels::of_groups(isa, groups, outputs / groups)
            }
        };
        let weights = match algorithm {
            Algorithm::Direct => kernel.direct(panels),
            Algorithm::Depthwise => vec![kernel.depthwise()],
            Algorithm::Winograd(tiling) => vec![kernel.winograd(panels, tiling)],
        };
        let bias = panels.spread(&shift);
        let is_finite = |values: &[f32]| values.iter().fold(true, |all, v| all & v.is_finite());
        if !weights.iter().all(|weights| is_finite(weights)) || !is_finite(&bias) {
            let what =
                format!("layer \"{}\": with its batch norm folded in, a weight", Excerpt(name));
            let cause = "the checkpoint is damaged, or its training diverged";
            return Err(Error::Overflow { what, cause });
        }
        let activation =
            match (&layer.convolution.activation, slopes(&layer.convolution.activation)) {
                (_, Some((name, shared))) => {
                    let slopes = take(tensors, &name)?;
                    let slopes = if shared { vec![slopes[0]; *outputs] } else { slopes };
                    PackedActivation::Prelu(panels.spread(&slopes))
                }
                (Activation::Relu, None) => PackedActivation::Relu,
                (Activation::Relu6, None) => PackedActivation::Relu6,
                (Activation::Logistic, None) => PackedActivation::Logistic,
                (_, None) => PackedActivation::None,
            };
        Ok(Self { algorithm, panels, weights, bias, activation })
    }

    /// Packs a linear layer's tensors from the checkpoint.
    ///
    /// # Errors
    /// Those of [`Self::convolution`].
    pub(crate) fn linear(
        isa: InstructionSet,
        name: &str,
        inputs: usize,
        outputs: usize,
        tensors: &mut dyn TensorSource,
    ) -> Result<Self, Error> {
        let matrix = take(tensors, &format!("{name}.weight"))?;
        let bias = take(tensors, &format!("{name}.bias"))?;
        let panels = Panels::of_groups(isa, 1, outputs);
        let weights = pack(panels, inputs, |output, column| {
            column.copy_from_slice(&matrix[output * inputs..][..inputs]);
        });
        let (algorithm, activation) = (Algorithm::Direct, PackedActivation::None);
        let bias = panels.spread(&bias);
        Ok(Self { algorithm, panels, weights: vec![weights], bias, activation })
    }

    /// Returns the operands of a phase's product.
    pub(crate) fn operands<'a>(&'a self, phase: usize, input: &'a [f32]) -> Operands<'a> {
        Operands { input, weights: &self.weights[phase], bias: &self.bias }
    }

    /// Returns the function that is applied to the sums.
    pub(crate) fn finish(&self) -> Finish<'_> {
        match &self.activation {
            PackedActivation::None => Finish::Keep,
            PackedActivation::Relu => Finish::Relu,
            PackedActivation::Relu6 => Finish::Relu6,
            PackedActivation::Logistic => Finish::Logistic,
            PackedActivation::Prelu(slopes) => Finish::Prelu(slopes),
        }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "the weights are f32")]
fn narrow(value: f64) -> f32 {
    value as f32
}

/// Bias and batch norm as one factor and one term per output channel.
struct Affine {
    scale: Vec<f64>,
    shift: Vec<f32>,
}

impl Affine {
    fn of(convolution: &Convolution, tensors: &mut dyn TensorSource) -> Result<Self, Error> {
        let bias = if convolution.bias {
            take(tensors, &format!("{}.bias", convolution.name))?
        } else {
            vec![0.0; convolution.outputs]
        };
        let Some(norm) = &convolution.norm else {
            return Ok(Self { scale: vec![1.0; convolution.outputs], shift: bias });
        };
        let mut part = |part| take(tensors, &format!("{}.{part}", norm.name));
        let (gain, shift, mean) = (part("weight")?, part("bias")?, part("running_mean")?);
        let variance = take_where(
            tensors,
            &format!("{}.running_var", norm.name),
            |value| value.is_finite() && value >= 0.0,
            "a finite number, zero or more: a variance",
        )?;
        let scale: Vec<f64> = gain
            .iter()
            .zip(&variance)
            .map(|(&gain, &variance)| f64::from(gain) / (f64::from(variance) + norm.epsilon).sqrt())
            .collect();
        let centre = bias.iter().zip(&mean).map(|(&bias, &mean)| f64::from(bias) - f64::from(mean));
        let shift = centre
            .zip(&scale)
            .zip(&shift)
            .map(|((centre, scale), &shift)| narrow(f64::from(shift) + centre * scale))
            .collect();
        Ok(Self { scale, shift })
    }
}

/// A kernel with the factor of each output channel.
struct Kernel<'a> {
    layer: &'a Layer,
    elements: Vec<f32>,
    scale: Vec<f64>,
}

impl Kernel<'_> {
    fn taps(&self) -> usize {
        self.layer.convolution.window.kernel.iter().product()
    }

    /// Returns the number of inputs of a group.
    fn inputs(&self) -> usize {
        self.layer.inputs / self.layer.convolution.groups
    }

    /// Returns how many groups are computed as one, with zeros between them, to fill a panel.
    fn groups_together(&self) -> usize {
        let Convolution { groups, outputs, .. } = self.layer.convolution;
        let fills = |count: &usize| {
            groups.is_multiple_of(*count) && count * (outputs / groups) >= NARROWEST
        };
        (1..=groups).find(fills).unwrap_or(groups)
    }

    /// Returns where the taps of an output's first input begin, and the distance to those of the
    /// next input.
    fn row(&self, output: usize) -> (usize, usize) {
        let Convolution { groups, outputs, transposed, .. } = self.layer.convolution;
        let (of_group, inputs, taps) = (outputs / groups, self.inputs(), self.taps());
        if transposed {
            let first = output / of_group * inputs * of_group + output % of_group;
            (first * taps, of_group * taps)
        } else {
            (output * inputs * taps, taps)
        }
    }

    /// Returns a matrix for each phase.
    fn direct(&self, panels: Panels) -> Vec<Buffer> {
        let Convolution { window, transposed, groups, outputs, .. } = self.layer.convolution;
        // The taps of a phase are the same for any size.
        let size = window.stride;
        let phases = if transposed { window.phases(size) } else { vec![window.whole(size)] };
        let together = groups / panels.groups;
        let inputs = self.inputs();
        let matrix = |phase: &Phase| {
            let taps = phase.kernel_taps(window.kernel);
            let depth = together * inputs;
            pack(panels, taps.len() * depth, |output, column| {
                let first = output / (outputs / groups) % together * inputs;
                let (start, step) = self.row(output);
                let scale = self.scale[output];
                column.fill(0.0);
                for (values, &tap) in column.chunks_exact_mut(depth).zip(&taps) {
                    let kernel = self.elements[start + tap..].iter().step_by(step);
                    for (value, &element) in values[first..first + inputs].iter_mut().zip(kernel) {
                        *value = narrow(f64::from(element) * scale);
                    }
                }
            })
        };
        phases.iter().map(matrix).collect()
    }

    /// Returns a row of channels for each tap.
    fn depthwise(&self) -> Buffer {
        let channels = self.layer.inputs;
        let taps = self.taps();
        let mut weights = Buffer::zeroed(taps * channels);
        for (tap, row) in weights.chunks_exact_mut(channels).enumerate() {
            let kernels = self.elements.chunks_exact(taps).zip(&self.scale);
            for (value, (kernel, scale)) in row.iter_mut().zip(kernels) {
                *value = narrow(f64::from(kernel[tap]) * scale);
            }
        }
        weights
    }

    fn winograd(&self, panels: Panels, tiling: crate::kernels::Tiling) -> Buffer {
        Winograd::pack(panels, tiling, self.layer.inputs, |output, input, values| {
            let (start, step) = self.row(output);
            let kernel = &self.elements[start + input * step..];
            for (value, &weight) in values.iter_mut().zip(kernel) {
                *value = f64::from(weight) * self.scale[output];
            }
        })
    }
}
