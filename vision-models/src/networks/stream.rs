//! SlowOnly on a camera's stream: a new score for each frame, with most activations reused.

use ndarray::{ArrayView2, ArrayView3};

use crate::engine::{
    Network, Plan, Scores, Session, check_finite, copy_frame, too_small, wrong_input,
};
use crate::error::Error;
use crate::layout::{Channels, offset};

use super::slow_only::SlowOnly;

/// SlowOnly over a sliding window of frames.
///
/// The kernels of the first half of the network (the stem and two stages) see one frame at a time.
/// Their activations are computed once per frame and kept. Only the second half is computed for
/// each window. The scores are bit for bit those of [`SlowOnly::infer`] on the window.
#[derive(Debug)]
pub struct SlowOnlyStream {
    network: Network,
    /// The pass from one frame to its activation.
    frame: Plan,
    /// The pass from the activations of the window to the scores.
    window: Session,
    frames: usize,
    /// Number of frames in the window so far.
    seen: usize,
    features: Vec<f32>,
    logits: Vec<f32>,
}

impl SlowOnlyStream {
    /// Creates a stream. `size` is the number of frames of a window, and the frames' height and
    /// width.
    ///
    /// # Errors
    /// [`Error::Size`] if a kernel or the head's windows do not fit.
    pub fn new(SlowOnly(network): SlowOnly, size: [usize; 3]) -> Result<Self, Error> {
        let [frames, height, width] = size;
        let program = &network.program;
        let cut = program.first_temporal_step().ok_or_else(|| too_small(size))?;
        let (cut, step) = cut;
        let (before, after) = program.steps.split_at(step);
        let frame = Plan::new(
            network.options.instruction_set,
            network.threads.count(),
            program,
            before,
            &network.weights.layers,
            &program.input_sizes([1, height, width]),
            &[cut],
        )?;
        let [_, rows, columns] =
            frame.outputs().next().map_or([0; 3], |(channels, _)| channels.layout.size);
        let window = network.session(after, &[(cut, [frames, rows, columns])])?;
        let features = vec![0.0; network.features()];
        let logits = vec![0.0; network.classes()];
        Ok(Self { network, frame, window, frames, seen: 0, features, logits })
    }

    /// Adds the next normalised frame, 3 × height × width, without scoring the window. This takes
    /// only the first half of the network, for streams whose frames come faster than scores.
    ///
    /// # Errors
    /// - [`Error::Size`] if the frame's size is not the stream's. The window is then unchanged.
    /// - [`Error::Value`] if a value is NaN or infinite. The window is then unchanged.
    pub fn add(&mut self, frame: ArrayView3<'_, f32>) -> Result<(), Error> {
        let (to, memory) = self.frame.input(0);
        let [_, rows, columns] = to.layout.size;
        let expected = [3, rows, columns];
        if frame.shape() != expected {
            let expected = format!("3 x {rows} x {columns}");
            return Err(Error::size("a frame", frame.shape(), "values", &expected));
        }
        copy_frame(&frame, [0, 0], 0, (to, memory))?;
        let Network { threads, weights, .. } = &self.network;
        self.frame.run(&mut threads.lock(), &weights.layers);
        let (to, window) = self.window.plan.input(0);
        if let Some(from) = self.frame.outputs().next() {
            slide(from, (to, window));
        }
        self.seen = (self.seen + 1).min(self.frames);
        Ok(())
    }

    /// Adds the next normalised frame, 3 × height × width. Returns the scores of the window if it
    /// is full.
    ///
    /// # Errors
    /// Those of [`add`](Self::add), and [`Error::Overflow`] as long as the window holds a frame whose
    /// activations overflow.
    pub fn push(&mut self, frame: ArrayView3<'_, f32>) -> Result<Option<Scores<'_>>, Error> {
        self.add(frame)?;
        if self.seen < self.frames {
            return Ok(None);
        }
        let Network { threads, weights, .. } = &self.network;
        self.window.run(&mut threads.lock(), weights, &mut self.features, &mut self.logits);
        check_finite(0, &self.features, &self.logits)?;
        let view = |data| {
            ArrayView2::from_shape((1, <[f32]>::len(data)), data)
                .map_err(|_| wrong_input(frame.shape()))
        };
        Ok(Some(Scores { logits: view(&self.logits)?, features: view(&self.features)? }))
    }

    /// Forgets all frames, to begin another recording.
    pub fn clear(&mut self) {
        self.seen = 0;
    }
}

/// Moves the window by one frame. Frames have the same layout on both sides except for the border.
fn slide((from, frame): (&Channels, &[f32]), (to, window): (&Channels, &mut [f32])) {
    let (layout, strides) = (to.layout, to.layout.strides());
    let [stride, ..] = strides;
    let first = layout.before[0] * stride;
    let last = first + (layout.size[0] - 1) * stride;
    window.copy_within(first + stride..last + stride, first);
    let [_, rows, columns] = from.layout.size;
    let line = columns * from.layout.channels;
    for row in 0..rows {
        let source = from.layout.origin() + offset([0, row, 0], from.layout.strides());
        let target = layout.origin() + offset([layout.size[0] - 1, row, 0], strides);
        window[target..target + line].copy_from_slice(&frame[source..source + line]);
    }
}
