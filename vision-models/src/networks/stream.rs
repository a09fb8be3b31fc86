//! SlowOnly on a camera's stream: a new score for each frame, most of it from what is known.

use ndarray::{ArrayView2, ArrayView3};

use crate::Error;
use crate::layout::{Layout, offset};

use super::network::{Network, Options, Scores, check_finite};
use super::plan::Plan;
use super::session::{Session, copy_frame};
use super::slow_only::SlowOnly;

/// SlowOnly over a sliding window of frames.
///
/// The kernels of the first half of the network (the stem and two stages) see one frame at a time,
/// so that its activations are computed once for each frame and kept; only the second half sees
/// the window anew. The scores are bit for bit those of [`SlowOnly::infer`] on the window.
#[derive(Debug)]
pub struct SlowOnlyStream {
    network: Network,
    /// From one frame to its activation.
    frame: Plan,
    /// From the activations of the window to the scores.
    window: Session,
    frames: usize,
    /// Frames in the window so far.
    seen: usize,
    features: Vec<f32>,
    logits: Vec<f32>,
}

impl SlowOnlyStream {
    /// A stream of frames of `height` × `width`, and a window of so many of them.
    ///
    /// # Errors
    /// [`Error::InputTooSmall`] if a kernel does not fit, [`Error::PoolTooSmall`] if the head's
    /// windows do not.
    pub fn new(SlowOnly(network): SlowOnly, size: [usize; 3]) -> Result<Self, Error> {
        let [frames, height, width] = size;
        let architecture = &network.architecture;
        let graph = &architecture.graph;
        let cut = architecture.first_temporal_step().ok_or(Error::InputTooSmall { size })?;
        let (value, step) = cut;
        let (before, after) = graph.steps.split_at(step);
        let Options { threads, instruction_set } = network.options;
        let frame = Plan::new(
            instruction_set,
            threads,
            graph,
            before,
            &network.weights.layers,
            &architecture.input_sizes([1, height, width]),
            &[value],
        )?;
        let [_, rows, columns] = frame.outputs().next().map_or([0; 3], |(layout, _)| layout.size);
        let window = network.plan(after, &[(value, [frames, rows, columns])])?;
        let features = vec![0.0; architecture.features()];
        let logits = vec![0.0; network.classes()];
        Ok(Self { network, frame, window, frames, seen: 0, features, logits })
    }

    /// Takes the next normalised frame, 3 × height × width, and scores the window, once it is full.
    ///
    /// # Errors
    /// [`Error::FrameShape`] if the frame has not the stream's size, [`Error::NotFinite`] if a
    /// value is NaN or infinite; the window stays as it was. [`Error::Overflow`] as long as a frame is in
    /// the window whose activations overflow.
    pub fn push(&mut self, frame: ArrayView3<'_, f32>) -> Result<Option<Scores<'_>>, Error> {
        let (layout, memory) = self.frame.input(0);
        let [_, rows, columns] = layout.size;
        let expected = [3, rows, columns];
        if frame.shape() != expected {
            let expected = format!("3 x {rows} x {columns}");
            return Err(Error::FrameShape { shape: frame.shape().to_vec(), expected });
        }
        copy_frame(&frame, [0, 0], 0, (layout, memory))?;
        self.frame.run(&mut self.network.threads, &self.network.weights.layers);
        let (to, window) = self.window.plan.input(0);
        if let Some(from) = self.frame.outputs().next() {
            slide(from, (to, window));
        }
        self.seen = (self.seen + 1).min(self.frames);
        if self.seen < self.frames {
            return Ok(None);
        }
        let Network { threads, weights, .. } = &mut self.network;
        self.window.run(threads, weights, &mut self.features, &mut self.logits);
        check_finite(0, &self.features, &self.logits)?;
        let view = |data| {
            ArrayView2::from_shape((1, <[f32]>::len(data)), data)
                .map_err(|_| Error::InputShape { shape: expected.to_vec() })
        };
        Ok(Some(Scores { logits: view(&self.logits)?, features: view(&self.features)? }))
    }

    /// Forgets all frames, as before another recording.
    pub fn clear(&mut self) {
        self.seen = 0;
    }
}

/// Moves the window on by one frame. Frames have the same layout on both sides but for the border.
fn slide((from, frame): (&Layout, &[f32]), (to, window): (&Layout, &mut [f32])) {
    let [stride, ..] = to.strides();
    let first = to.before[0] * stride;
    let last = first + (to.size[0] - 1) * stride;
    window.copy_within(first + stride..last + stride, first);
    let [_, rows, columns] = from.size;
    let line = columns * from.channels;
    for row in 0..rows {
        let source = from.origin() + offset([0, row, 0], from.strides());
        let target = to.origin() + offset([to.size[0] - 1, row, 0], to.strides());
        window[target..target + line].copy_from_slice(&frame[source..source + line]);
    }
}
