//! Convolution as a matrix product over the taps.

use crate::layout::{Extent, Layout, offset, position};

use super::buffer::Buffer;
use super::isa::InstructionSet;
use super::pack::Panels;
use super::product::{Product, Segment, Start};
use super::shared_slice::SharedSlice;
use super::threads::Pool;

/// Pixels of a block: their inputs stay in the second-level cache while the panels go by.
const BLOCK: usize = 96;
/// Floats of a pixel's input that are worked off at once.
const CHUNK: usize = 512;

/// What a convolution does with its sums.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Epilogue {
    /// Adds what the output holds (the residual connection).
    pub(crate) add: bool,
    /// Makes negative results zero, and NaN of those that are not finite.
    pub(crate) relu: bool,
}

/// A convolution's window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Window {
    /// Frames, rows and columns of the kernel.
    pub(crate) kernel: Extent,
    /// Steps from one output to the next.
    pub(crate) stride: Extent,
    /// Zeros around the input.
    pub(crate) padding: Extent,
}

impl Window {
    /// The output's size for an input's, or `None` if the kernel does not fit.
    pub(crate) fn output(&self, size: Extent) -> Option<Extent> {
        let mut output = [0; 3];
        for axis in 0..3 {
            let padded = size[axis] + 2 * self.padding[axis];
            output[axis] = padded.checked_sub(self.kernel[axis])? / self.stride[axis] + 1;
        }
        Some(output)
    }
}

/// A convolution for one input size: everything but the numbers.
#[derive(Clone, Debug)]
pub(crate) struct Direct {
    isa: InstructionSet,
    panels: Panels,
    stride: Extent,
    input: Layout,
    output: Layout,
    /// First channel of the output that is written.
    first_channel: usize,
    /// Where the input of the first pixel starts.
    origin: usize,
    chunks: Vec<Vec<Segment>>,
    depth: usize,
    /// How far a pixel's input reaches.
    reach: usize,
}

impl Direct {
    /// Plans the convolution of the first `inputs` channels of `input`, whose border is at least
    /// the padding, into the channels of `output` from `first_channel` on.
    ///
    /// # Panics
    /// If the border is smaller, the output has another size than the window gives, or either
    /// layout has too few channels.
    pub(crate) fn new(
        isa: InstructionSet,
        panels: Panels,
        window: Window,
        (input, inputs): (Layout, usize),
        (output, first_channel): (Layout, usize),
    ) -> Self {
        assert!(input.has_border_of(window.padding, window.padding));
        assert_eq!(window.output(input.size), Some(output.size), "{window:?} over {input:?}");
        assert!(inputs > 0 && inputs <= input.channels);
        assert!(first_channel + panels.channels <= output.channels);
        let strides = input.strides();
        let before: Extent = std::array::from_fn(|axis| input.before[axis] - window.padding[axis]);
        let [frames, rows, columns] = window.kernel;
        // Neighbouring pixels are one segment, unless there are channels between to leave out.
        let (pieces, length) =
            if inputs == input.channels { (1, columns * inputs) } else { (columns, inputs) };
        let mut chunks = Chunks::default();
        for frame in 0..frames {
            for row in 0..rows {
                for column in 0..pieces {
                    chunks.push(Segment { offset: offset([frame, row, column], strides), length });
                }
            }
        }
        let chunks = chunks.chunks;
        let segments = || chunks.iter().flatten();
        Self {
            isa,
            panels,
            stride: window.stride,
            input,
            output,
            first_channel,
            origin: offset(before, strides),
            depth: segments().map(|segment| segment.length).sum(),
            reach: segments().map(|segment| segment.offset + segment.length).max().unwrap_or(0),
            chunks,
        }
    }

    /// Runs the convolution.
    ///
    /// # Panics
    /// If a slice is shorter than its layout.
    pub(crate) fn run(
        &self,
        pool: &mut Pool,
        input: &[f32],
        weights: &Buffer,
        bias: &[f32],
        output: &mut [f32],
        epilogue: Epilogue,
    ) {
        let panels = self.panels;
        assert!(weights.len() >= panels.padded() * self.depth && bias.len() >= panels.padded());
        assert!(input.len() >= self.input.length() && output.len() >= self.output.length());
        let output = SharedSlice::new(output);
        let (blocks, groups) = self.split(pool.lanes());
        let pixels = self.output.pixels();
        pool.run(blocks * groups, &|_, task| {
            let (block, group) = (task % blocks, task / blocks);
            let pixels = share(pixels, blocks, block);
            let mut starts = [[0; BLOCK]; 2];
            let mut first = pixels.start;
            while first < pixels.end {
                let count = BLOCK.min(pixels.end - first);
                let [rows, output_rows] = &mut starts;
                for (index, (row, output_row)) in
                    rows.iter_mut().zip(output_rows.iter_mut()).take(count).enumerate()
                {
                    let at = position(first + index, self.output.size);
                    let moved = std::array::from_fn(|axis| at[axis] * self.stride[axis]);
                    *row = self.origin + offset(moved, self.input.strides());
                    *output_row = self.output.origin()
                        + offset(at, self.output.strides())
                        + self.first_channel;
                    assert!(*row + self.reach <= input.len());
                    assert!(*output_row + panels.channels <= output.len());
                }
                for panel in share(panels.count(), groups, group) {
                    let bias = &bias[panel * panels.width..][..panels.width];
                    let product = Product {
                        input: input.as_ptr(),
                        rows: &rows[..count],
                        chunks: &self.chunks,
                        weights: weights[panel * panels.width * self.depth..].as_ptr(),
                        width: panels.width,
                        channels: panels.channels_of(panel),
                        output: output.at(panel * panels.width),
                        output_rows: &output_rows[..count],
                        start: if epilogue.add {
                            Start::BiasAndOutput(bias)
                        } else {
                            Start::Bias(bias)
                        },
                        relu: epilogue.relu,
                    };
                    // SAFETY: the rows were checked against both slices, the weights and biases
                    // against the panels; no other task has these pixels and this panel.
                    unsafe { self.isa.run(product) };
                }
                first += count;
            }
        });
    }

    /// Into how many blocks of pixels and groups of panels the tasks are cut: the larger of the
    /// activations and the weights is what a thread should have for itself.
    fn split(&self, lanes: usize) -> (usize, usize) {
        let pixels = self.output.pixels();
        if lanes == 1 {
            return (1, 1);
        }
        if self.panels.channels > pixels {
            let groups = self.panels.count().min(2 * lanes);
            (1, groups)
        } else {
            (pixels.div_ceil(BLOCK).next_multiple_of(lanes).min(pixels), 1)
        }
    }
}

/// The `index`-th of `parts` even shares of `total` things.
pub(super) fn share(total: usize, parts: usize, index: usize) -> std::ops::Range<usize> {
    total * index / parts..total * (index + 1) / parts
}

/// Segments, grouped into chunks of at most [`CHUNK`] floats.
#[derive(Debug, Default)]
struct Chunks {
    chunks: Vec<Vec<Segment>>,
    room: usize,
}

impl Chunks {
    fn push(&mut self, mut segment: Segment) {
        while segment.length > 0 {
            // A piece shorter than this costs more in loads and stores of the sums than it saves.
            if self.room < segment.length.min(CHUNK / 4) {
                self.chunks.push(Vec::new());
                self.room = CHUNK;
            }
            let length = segment.length.min(self.room);
            if let Some(chunk) = self.chunks.last_mut() {
                chunk.push(Segment { offset: segment.offset, length });
            }
            self.room -= length;
            segment = Segment { offset: segment.offset + length, length: segment.length - length };
        }
    }
}
