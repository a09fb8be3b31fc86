//! A network's forward pass for one input size, from pixels to scores.

use ndarray::{ArrayView3, ArrayView4, Axis};

use crate::error::Error;
use crate::kernels::{Direct, Epilogue, Finish, InstructionSet, Pool, Window};
use crate::layout::{Channels, Extent, Layout, offset, position};

use super::graph::Frames;
use super::head::pool as pool_features;
use super::packed::Packed;
use super::plan::Plan;
use super::program::{Classifier, Program, Slot, Step};

/// A network's weights, as the kernels read them.
#[derive(Debug)]
pub(crate) struct Weights {
    pub(crate) layers: Vec<Packed>,
    /// The classifier, or none if the checkpoint has none.
    pub(crate) classifier: Option<Packed>,
}

/// The planned forward pass from some inputs to the ends.
#[derive(Debug)]
pub(crate) struct Session {
    pub(crate) plan: Plan,
    /// Number of the plan's outputs that are the network's. The pooled activations follow them.
    maps: usize,
    /// The weight of each pixel of each pooled activation in the features.
    pixel_weights: Vec<Vec<f32>>,
    classify: Option<Direct>,
}

impl Session {
    /// Plans `steps`, which end at the network's ends.
    pub(crate) fn new(
        isa: InstructionSet,
        lanes: usize,
        program: &Program,
        weights: &Weights,
        steps: &[Step],
        inputs: &[(Slot, Extent)],
    ) -> Result<Self, Error> {
        let ends = program.ends();
        let plan = Plan::new(isa, lanes, program, steps, &weights.layers, inputs, &ends)?;
        let maps = program.outputs.len();
        let pooled = program.classifier.iter().flat_map(|classifier| &classifier.pooled);
        let pixel_weights = pooled
            .zip(plan.outputs().skip(maps))
            .map(|((_, pooling), (channels, _))| pooling.pixel_weights(&channels.layout))
            .collect::<Result<_, _>>()?;
        let classify = weights.classifier.as_ref().map(|classifier| {
            let features = program.classifier.as_ref().map_or(0, Classifier::features);
            let pixel = |count| Channels { layout: Layout::dense([1; 3], count), first: 0, count };
            let panels = classifier.panels;
            let whole = Window::same([1; 3]).whole([1; 3]);
            Direct::new(isa, panels, &whole, pixel(features), pixel(panels.outputs()))
        });
        Ok(Self { plan, maps, pixel_weights, classify })
    }

    /// Runs the network on the contents of its inputs.
    pub(crate) fn run(
        &mut self,
        pool: &mut Pool,
        weights: &Weights,
        features: &mut [f32],
        logits: &mut [f32],
    ) {
        self.plan.run(pool, &weights.layers);
        let mut rest = &mut features[..];
        for (weights, (channels, memory)) in
            self.pixel_weights.iter().zip(self.plan.outputs().skip(self.maps))
        {
            let (part, others) = rest.split_at_mut(channels.count);
            pool_features(weights, (memory, channels), part);
            rest = others;
        }
        if let (Some(classify), Some(packed)) = (&self.classify, &weights.classifier) {
            let epilogue = Epilogue { add: false, finish: Finish::Keep };
            classify.run(pool, packed.operands(0, features), logits, epilogue);
        }
    }

    /// Returns the layout and the memory of each of the network's outputs.
    pub(crate) fn maps(&self) -> impl Iterator<Item = (&Channels, &[f32])> {
        self.plan.outputs().take(self.maps)
    }
}

/// Copies an output, pixel by pixel, and returns true if it is finite.
pub(crate) fn copy_map((from, memory): (&Channels, &[f32]), map: &mut [f32]) -> bool {
    let layout = from.layout;
    // The pixels of a row are contiguous, unless some channels are left out.
    let pixels = if from.count == layout.channels { layout.size[2] } else { 1 };
    let mut zero = 0.0;
    for (index, run) in map.chunks_exact_mut(pixels * from.count).enumerate() {
        let start = from.origin() + offset(position(index * pixels, layout.size), layout.strides());
        run.copy_from_slice(&memory[start..start + run.len()]);
        zero = run.iter().fold(zero, |zero, &value| zero + 0.0 * value);
    }
    zero == 0.0
}

/// Copies the frames of a clip that an input takes. The clip is channels × frames × height × width.
pub(crate) fn copy_clip(
    clip: &ArrayView4<'_, f32>,
    index: usize,
    frames: Frames,
    (to, memory): (&Channels, &mut [f32]),
) -> Result<(), Error> {
    let (given, taken) = (clip.len_of(Axis(1)), to.layout.size[0]);
    for frame in 0..taken {
        let source = frames.source(frame, taken, given);
        let image = clip.index_axis(Axis(1), source);
        copy_frame(&image, [index, source], frame, (to, memory))?;
    }
    Ok(())
}

/// Copies a channels × height × width image into a frame of an input, channels innermost. An error
/// names the image by its clip and its frame in the clip.
pub(crate) fn copy_frame(
    image: &ArrayView3<'_, f32>,
    [clip, source]: [usize; 2],
    frame: usize,
    (to, memory): (&Channels, &mut [f32]),
) -> Result<(), Error> {
    let strides = to.layout.strides();
    for (row, lines) in image.axis_iter(Axis(1)).enumerate() {
        for (channel, line) in lines.outer_iter().enumerate() {
            let finite = line.fold(true, |finite, value| finite & value.is_finite());
            if !finite && let Some(column) = line.iter().position(|value| !value.is_finite()) {
                let index = [clip, channel, source, row, column];
                let pixel = format!("pixel {index:?} (clip, channel, frame, row, column)");
                return Err(Error::value(&pixel, line[column], "finite values"));
            }
        }
        let start = to.origin() + offset([frame, row, 0], strides);
        for (channel, line) in lines.outer_iter().enumerate() {
            let targets = memory[start + channel..].iter_mut().step_by(strides[2]);
            for (target, &value) in targets.zip(line) {
                *target = value;
            }
        }
    }
    Ok(())
}
