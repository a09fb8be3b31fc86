//! Depthwise convolution: each channel by itself.

use crate::layout::{Channels, Extent, offset, position};

use super::direct::{Operands, share};
use super::epilogue::Epilogue;
use super::isa::{InstructionSet, Task};
use super::shared_slice::SharedSlice;
use super::threads::Pool;
use super::vector::Vector;
use super::window::Phase;

/// Pixels per register tile.
const TILE: usize = 4;

/// A depthwise convolution for one input size, without its weights. The weights are a row of
/// channels for each tap, in the order of [`Phase::kernel_taps`].
#[derive(Clone, Debug)]
pub(crate) struct Depthwise {
    isa: InstructionSet,
    input: Channels,
    output: Channels,
    size: Extent,
    /// Start of the first pixel's input, measured from its first tap.
    origin: usize,
    input_step: Extent,
    output_step: Extent,
    /// Offset of each tap from the start of a pixel's input.
    taps: Vec<usize>,
}

impl Depthwise {
    /// Plans a phase that has all outputs, in order.
    ///
    /// # Panics
    /// - If the phase does not fit the sizes and the input's border, or lacks outputs.
    /// - If the channels do not exist, or input and output have different numbers of them.
    pub(crate) fn new(
        isa: InstructionSet,
        phase: &Phase,
        input: Channels,
        output: Channels,
    ) -> Self {
        let from = input.layout;
        assert!(phase.fits(&from, &output.layout), "{phase:?} from {input:?} to {output:?}");
        assert_eq!(phase.size, output.layout.size);
        assert!(input.exist() && output.exist() && input.count == output.count);
        let strides = from.strides();
        let first = |axis: usize| phase.taps[axis].iter().map(|tap| tap.offset).min().unwrap_or(0);
        let firsts = [first(0), first(1), first(2)];
        let corner: Extent =
            std::array::from_fn(|axis| from.before[axis].saturating_add_signed(firsts[axis]));
        let mut taps = Vec::new();
        for frame in &phase.taps[0] {
            for row in &phase.taps[1] {
                for column in &phase.taps[2] {
                    let at = [frame, row, column].map(|tap| tap.offset);
                    let at = std::array::from_fn(|axis| (at[axis] - firsts[axis]).unsigned_abs());
                    taps.push(offset(at, strides));
                }
            }
        }
        Self {
            isa,
            input,
            output,
            size: phase.size,
            origin: offset(corner, strides) + input.first,
            input_step: std::array::from_fn(|axis| phase.input_step[axis] * strides[axis]),
            output_step: output.layout.strides(),
            taps,
        }
    }

    /// Runs the convolution.
    ///
    /// # Panics
    /// If a slice is shorter than its layout or the channels.
    pub(crate) fn run(
        &self,
        pool: &mut Pool,
        Operands { input, weights, bias }: Operands<'_>,
        output: &mut [f32],
        epilogue: Epilogue<'_>,
    ) {
        let channels = self.input.count;
        assert!(input.len() >= self.input.layout.length());
        assert!(output.len() >= self.output.layout.length());
        assert!(weights.len() >= channels * self.taps.len());
        assert!(bias.len() >= channels && epilogue.finish.has_slopes(channels));
        let output = SharedSlice::new(output);
        let [frames, rows, columns] = self.size;
        let lines = frames * rows;
        let reach = self.taps.iter().max().copied().unwrap_or(0) + channels;
        let tasks = lines.min(8 * pool.lanes());
        pool.run(tasks, &|_, task| {
            for line in share(lines, tasks, task) {
                let at = position(line * columns, self.size);
                let from = self.origin + offset(at, self.input_step);
                let to = self.output.origin() + offset(at, self.output_step);
                let last = columns - 1;
                assert!(from + last * self.input_step[2] + reach <= input.len());
                assert!(to + last * self.output_step[2] + channels <= output.len());
                let line = Line {
                    input: input[from..].as_ptr(),
                    input_step: self.input_step[2],
                    taps: &self.taps,
                    weights,
                    bias,
                    channels,
                    output: output.at(to),
                    output_step: self.output_step[2],
                    pixels: columns,
                    epilogue,
                };
                // SAFETY: the line was checked against both slices, weights and biases against the
                // channels. No other task has this line.
                unsafe { self.isa.run(line) };
            }
        });
    }
}

/// A row of output pixels.
struct Line<'a> {
    input: *const f32,
    input_step: usize,
    taps: &'a [usize],
    weights: &'a [f32],
    bias: &'a [f32],
    channels: usize,
    output: *mut f32,
    output_step: usize,
    pixels: usize,
    epilogue: Epilogue<'a>,
}

/// Requires that all taps of all pixels lie inside the input and all pixels inside the output. No
/// other thread may use these pixels. There must be weights, biases and slopes for all channels.
impl Task for Line<'_> {
    #[inline(always)]
    unsafe fn run<V: Vector>(self) {
        // SAFETY: passed on to the caller.
        unsafe {
            let whole = self.registers::<V>(0);
            let whole = self.registers::<V::Half>(whole);
            for channel in whole..self.channels {
                for pixel in 0..self.pixels {
                    self.one(channel, pixel);
                }
            }
        }
    }
}

impl Line<'_> {
    /// Computes the channels from `first` on that fill whole registers. Returns the first channel
    /// behind them.
    #[inline(always)]
    unsafe fn registers<V: Vector>(&self, first: usize) -> usize {
        let end = self.channels - (self.channels - first) % V::LANES;
        for channel in (first..end).step_by(V::LANES) {
            let mut pixel = 0;
            // SAFETY: passed on to the caller.
            unsafe {
                while pixel + TILE <= self.pixels {
                    self.tile::<V, TILE>(channel, pixel);
                    pixel += TILE;
                }
                for pixel in pixel..self.pixels {
                    self.tile::<V, 1>(channel, pixel);
                }
            }
        }
        end
    }

    /// Computes a register of channels of `PIXELS` neighbouring pixels.
    #[inline(always)]
    unsafe fn tile<V: Vector, const PIXELS: usize>(&self, channel: usize, pixel: usize) {
        // SAFETY: passed on to the caller.
        unsafe {
            let input = self.input.add(pixel * self.input_step + channel);
            let output = self.output.add(pixel * self.output_step + channel);
            let mut sums = [V::splat(0.0); PIXELS];
            let mut weights = self.weights.as_ptr().add(channel);
            for &tap in self.taps {
                let weight = V::load(weights);
                for (at, sum) in sums.iter_mut().enumerate() {
                    *sum = V::load(input.add(tap + at * self.input_step)).mul_add(weight, *sum);
                }
                weights = weights.wrapping_add(self.channels);
            }
            let bias = V::load(self.bias.as_ptr().add(channel));
            for (at, sum) in sums.into_iter().enumerate() {
                let sum = sum.add(bias);
                let to = output.add(at * self.output_step);
                let sum = if self.epilogue.add { sum.add(V::load(to)) } else { sum };
                self.epilogue.finish.apply(sum, channel).store(to);
            }
        }
    }

    /// Computes one channel of one pixel, for channels that do not fill a register.
    #[inline(always)]
    unsafe fn one(&self, channel: usize, pixel: usize) {
        // SAFETY: passed on to the caller.
        unsafe {
            let input = self.input.add(pixel * self.input_step + channel);
            let to = self.output.add(pixel * self.output_step + channel);
            let weights = self.weights[channel..].iter().step_by(self.channels);
            let products =
                self.taps.iter().zip(weights).map(|(&tap, weight)| *input.add(tap) * weight);
            let sum = self.bias[channel] + products.sum::<f32>();
            let sum = if self.epilogue.add { sum + *to } else { sum };
            *to = self.epilogue.finish.apply_to_one(sum, channel);
        }
    }
}
