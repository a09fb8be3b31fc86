//! Convolution as a matrix product over the taps.

use crate::layout::{Channels, Extent, offset, position};

use super::buffer::Buffer;
use super::epilogue::Epilogue;
use super::isa::InstructionSet;
use super::pack::Panels;
use super::product::{Beside, Product, Segment};
use super::shared_slice::SharedSlice;
use super::threads::Pool;
use super::window::{Phase, Tap};

/// Pixels of a block. Their inputs stay in the second-level cache for all panels.
const BLOCK: usize = 96;
/// Floats of a pixel's input that are processed at once.
const CHUNK: usize = 512;

/// The operands of a convolution, as packed for its kernel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Operands<'a> {
    /// The activation that is read.
    pub(crate) input: &'a [f32],
    /// The packed weights.
    pub(crate) weights: &'a Buffer,
    /// Bias of each channel of the panels.
    pub(crate) bias: &'a [f32],
}

/// A convolution for one input size, without its weights.
#[derive(Clone, Debug)]
pub(crate) struct Direct {
    isa: InstructionSet,
    panels: Panels,
    input: Channels,
    output: Channels,
    /// Outputs along each axis.
    size: Extent,
    /// Start of the first pixel's input.
    origin: usize,
    /// Floats from the input of one pixel to that of the next, along each axis.
    input_step: Extent,
    /// Start of the first pixel of the output.
    output_origin: usize,
    /// Floats from one pixel of the output to the next, along each axis.
    output_step: Extent,
    chunks: Vec<Vec<Segment>>,
    depth: usize,
    /// Extent of a pixel's input.
    reach: usize,
}

impl Direct {
    /// Plans one phase of a convolution. Each group of the panels reads its share of the input
    /// channels.
    ///
    /// # Panics
    /// - If the phase does not fit the sizes and the input's border.
    /// - If the channels do not exist or are not those of the panels.
    pub(crate) fn new(
        isa: InstructionSet,
        panels: Panels,
        phase: &Phase,
        input: Channels,
        output: Channels,
    ) -> Self {
        let from = input.layout;
        assert!(phase.fits(&from, &output.layout), "{phase:?} from {input:?} to {output:?}");
        assert!(input.exist() && output.exist());
        assert!(input.count.is_multiple_of(panels.groups) && output.count == panels.outputs());
        let inputs = input.count / panels.groups;
        let strides = from.strides();
        // Taps are counted from the first one, so that no offset is negative.
        let [frame_taps, row_taps, column_taps] = &phase.taps;
        let firsts =
            [0, 1, 2].map(|axis| phase.taps[axis].iter().map(|tap| tap.offset).min().unwrap_or(0));
        let ahead = |axis: usize, tap: &Tap| (tap.offset - firsts[axis]).unsigned_abs();
        let corner: Extent =
            std::array::from_fn(|axis| from.before[axis].saturating_add_signed(firsts[axis]));
        // Neighbouring pixels form one segment, unless channels or pixels between them are left
        // out.
        let neighbours = (0..).zip(column_taps).all(|(at, tap)| ahead(2, tap) == at);
        let (pieces, length) = if neighbours && inputs == from.channels {
            (&column_taps[..column_taps.len().min(1)], column_taps.len() * inputs)
        } else {
            (&column_taps[..], inputs)
        };
        let mut chunks = Chunks::default();
        for frame in frame_taps {
            for row in row_taps {
                for column in pieces {
                    let at = [ahead(0, frame), ahead(1, row), ahead(2, column)];
                    chunks.push(Segment { offset: offset(at, strides), length });
                }
            }
        }
        let chunks = chunks.chunks;
        let segments = || chunks.iter().flatten();
        let steps =
            |step: Extent, strides: Extent| std::array::from_fn(|axis| step[axis] * strides[axis]);
        let output_strides = output.layout.strides();
        Self {
            isa,
            panels,
            input,
            output,
            size: phase.size,
            origin: offset(corner, strides) + input.first,
            input_step: steps(phase.input_step, strides),
            output_origin: output.origin() + offset(phase.start, output_strides),
            output_step: steps(phase.step, output_strides),
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
        Operands { input, weights, bias }: Operands<'_>,
        output: &mut [f32],
        Epilogue { add, finish }: Epilogue<'_>,
    ) {
        let panels = self.panels;
        assert!(weights.len() >= panels.padded() * self.depth);
        assert!(bias.len() >= panels.padded() && finish.has_slopes(panels.padded()));
        assert!(input.len() >= self.input.layout.length());
        assert!(output.len() >= self.output.layout.length());
        let output = SharedSlice::new(output);
        let (blocks, tasks) = self.split(pool.lanes());
        let pixels: usize = self.size.iter().product();
        // The input that all groups read, and the output that all panels write.
        let group_inputs = self.input.count / panels.groups;
        let reach = self.reach + self.input.count - group_inputs;
        pool.run(blocks * tasks, &|_, task| {
            let (block, part) = (task % blocks, task / blocks);
            let pixels = share(pixels, blocks, block);
            let mut starts = [[0; BLOCK]; 2];
            let mut first = pixels.start;
            while first < pixels.end {
                let count = BLOCK.min(pixels.end - first);
                let [rows, output_rows] = &mut starts;
                // Pixels of a row of the output are contiguous up to a stride on both sides.
                let mut done = 0;
                while done < count {
                    let at = position(first + done, self.size);
                    let run = (self.size[2] - at[2]).min(count - done);
                    let row = self.origin + offset(at, self.input_step);
                    let output_row = self.output_origin + offset(at, self.output_step);
                    let (step, output_step) = (self.input_step[2], self.output_step[2]);
                    let last = run - 1;
                    assert!(row + last * step + reach <= input.len());
                    assert!(output_row + last * output_step + panels.outputs() <= output.len());
                    let starts = rows[done..][..run].iter_mut().zip(&mut output_rows[done..]);
                    for (index, (start, output_start)) in starts.enumerate() {
                        *start = row + index * step;
                        *output_start = output_row + index * output_step;
                    }
                    done += run;
                }
                for panel in share(panels.count(), tasks, part) {
                    let start = panel * panels.width;
                    let bias = &bias[start..][..panels.width];
                    let product = Product {
                        input: input[panels.group(panel) * group_inputs..].as_ptr(),
                        rows: &rows[..count],
                        chunks: &self.chunks,
                        weights: weights[start * self.depth..].as_ptr(),
                        width: panels.width,
                        channels: panels.channels_of(panel),
                        output: output.at(panels.first(panel)),
                        output_rows: &output_rows[..count],
                        beside: if add { Beside::BiasAndOutput(bias) } else { Beside::Bias(bias) },
                        finish: finish.of_panel(start, panels.width),
                    };
                    // SAFETY: the rows were checked against both slices, and weights, biases and
                    // slopes against the panels. No other task has these pixels and this panel.
                    unsafe { self.isa.run(product) };
                }
                first += count;
            }
        });
    }

    /// Returns the number of blocks of pixels and of parts of the panels for the tasks. Threads
    /// divide the larger of the activations and the weights among them.
    fn split(&self, lanes: usize) -> (usize, usize) {
        let pixels: usize = self.size.iter().product();
        if lanes == 1 {
            return (1, 1);
        }
        if self.panels.outputs() > pixels {
            (1, self.panels.count().min(2 * lanes))
        } else {
            (pixels.div_ceil(BLOCK).next_multiple_of(lanes).min(pixels), 1)
        }
    }
}

/// Returns the `index`-th of `parts` nearly equal shares of `total` elements.
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
