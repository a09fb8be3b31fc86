//! A network's forward pass for one input size, from pixels to scores.

use ndarray::{ArrayView3, ArrayView4, Axis};

use crate::Error;
use crate::kernels::{Direct, Epilogue, InstructionSet, Pool, Window};
use crate::layout::{Extent, Layout, offset};

use super::graph::{Architecture, Step, Value};
use super::head::pool;
use super::parameters::Packed;
use super::plan::Plan;

/// A network's weights, as the kernels read them.
#[derive(Debug)]
pub(crate) struct Weights {
    pub(crate) layers: Vec<Packed>,
    pub(crate) classifier: Packed,
}

/// The forward pass from some inputs to the scores, planned.
#[derive(Debug)]
pub(crate) struct Session {
    pub(crate) plan: Plan,
    /// The weight of each pixel of each output in the features.
    pixel_weights: Vec<Vec<f32>>,
    classify: Direct,
}

impl Session {
    /// Plans `steps`, which end where the network does.
    pub(crate) fn new(
        isa: InstructionSet,
        lanes: usize,
        architecture: &Architecture,
        weights: &Weights,
        steps: &[Step],
        inputs: &[(Value, Extent)],
    ) -> Result<Self, Error> {
        let outputs: Vec<Value> = architecture.outputs.iter().map(|&(value, _)| value).collect();
        let plan =
            Plan::new(isa, lanes, &architecture.graph, steps, &weights.layers, inputs, &outputs)?;
        let pixel_weights = architecture
            .outputs
            .iter()
            .zip(plan.outputs())
            .map(|((_, pooling), (layout, _))| pooling.pixel_weights(layout))
            .collect::<Result<_, _>>()?;
        let panels = weights.classifier.panels;
        let features = Layout::dense([1; 3], architecture.features());
        let scores = Layout::dense([1; 3], panels.channels);
        let window = Window { kernel: [1; 3], stride: [1; 3], padding: [0; 3] };
        let classify = Direct::new(isa, panels, window, (features, features.channels), (scores, 0));
        Ok(Self { plan, pixel_weights, classify })
    }

    /// Runs the network on what its inputs hold.
    pub(crate) fn run(
        &mut self,
        threads: &mut Pool,
        weights: &Weights,
        features: &mut [f32],
        logits: &mut [f32],
    ) {
        self.plan.run(threads, &weights.layers);
        let mut rest = &mut features[..];
        for (weights, (layout, memory)) in self.pixel_weights.iter().zip(self.plan.outputs()) {
            let (part, others) = rest.split_at_mut(layout.channels);
            pool(weights, (memory, layout), part);
            rest = others;
        }
        let Packed { weights, bias, .. } = &weights.classifier;
        let epilogue = Epilogue { add: false, relu: false };
        self.classify.run(threads, features, weights, bias, logits, epilogue);
    }
}

/// Copies a clip, 3 × frames × height × width, into an input that takes so many of its frames,
/// spread evenly from the first to the last.
pub(crate) fn copy_clip(
    clip: &ArrayView4<'_, f32>,
    index: usize,
    (layout, memory): (&Layout, &mut [f32]),
) -> Result<(), Error> {
    let (given, taken) = (clip.len_of(Axis(1)), layout.size[0]);
    for frame in 0..taken {
        let source = frame * (given - 1) / (taken - 1).max(1);
        let image = clip.index_axis(Axis(1), source);
        copy_frame(&image, [index, source], frame, (layout, memory))?;
    }
    Ok(())
}

/// Copies a 3 × height × width image into a frame of an input, channels innermost. An error names
/// the image by its clip and its frame there.
pub(crate) fn copy_frame(
    image: &ArrayView3<'_, f32>,
    [clip, source]: [usize; 2],
    frame: usize,
    (layout, memory): (&Layout, &mut [f32]),
) -> Result<(), Error> {
    let strides = layout.strides();
    for (row, lines) in image.axis_iter(Axis(1)).enumerate() {
        for (channel, line) in lines.outer_iter().enumerate() {
            let finite = line.fold(true, |finite, value| finite & value.is_finite());
            if !finite && let Some(column) = line.iter().position(|value| !value.is_finite()) {
                let index = [clip, channel, source, row, column];
                return Err(Error::NotFinite { value: line[column], index });
            }
        }
        let start = layout.origin() + offset([frame, row, 0], strides);
        let pixels = memory[start..].chunks_exact_mut(strides[2]);
        for (pixel, values) in pixels.zip(lines.axis_iter(Axis(1))) {
            for (target, &value) in pixel.iter_mut().zip(values) {
                *target = value;
            }
        }
    }
    Ok(())
}
