//! The matrix product that computes every direct convolution.
//!
//! out\[pixel\]\[channel\] = Σₖ input\[pixel's start + offset(k)\] · weights\[k\]\[channel\]
//!
//! Activations have a physical zero border, so that each tap of a convolution is a constant offset
//! from the start of a pixel's input. A run of neighbouring taps and channels is a [`Segment`]. The
//! same kernel therefore computes 1×1, 3×3, 7×7, strided and temporal convolutions without a copy.

use super::epilogue::Finish;
use super::isa::Task;
use super::vector::{Vector, prefetch};

/// Rows (pixels) of the register tile.
pub(super) const TILE_ROWS: usize = 6;
/// The widest panel.
pub(super) const MAX_PANEL: usize = 64;

/// A contiguous piece of a pixel's input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Segment {
    /// Offset from the start of the pixel's input.
    pub(crate) offset: usize,
    /// Number of floats.
    pub(crate) length: usize,
}

/// Term that is added to the products.
#[derive(Clone, Copy, Debug)]
pub(super) enum Beside<'a> {
    /// Nothing.
    Nothing,
    /// The bias of each channel.
    Bias(&'a [f32]),
    /// The bias of each channel, and the output's previous value: the residual connection.
    BiasAndOutput(&'a [f32]),
}

/// A block of pixels times one panel of weights.
#[derive(Clone, Copy, Debug)]
pub(super) struct Product<'a> {
    /// The activations.
    pub(super) input: *const f32,
    /// Start of each pixel's input.
    pub(super) rows: &'a [usize],
    /// The pieces of each pixel's input, in chunks whose weights fit the caches.
    pub(super) chunks: &'a [Vec<Segment>],
    /// A row of `width` weights for each float of a pixel's input, in order.
    pub(super) weights: *const f32,
    /// Channels of the panel: half a register, or one, two or four, at most [`MAX_PANEL`].
    pub(super) width: usize,
    /// Number of channels that exist, at most `width`.
    pub(super) channels: usize,
    /// The output's first float for the panel's first channel.
    pub(super) output: *mut f32,
    /// Start of each pixel's output.
    pub(super) output_rows: &'a [usize],
    /// Term that is added to the products.
    pub(super) beside: Beside<'a>,
    /// The function that is applied to the sums.
    pub(super) finish: Finish<'a>,
}

/// Requirements:
/// - `rows` and `output_rows` have the same length.
/// - Every segment of every row lies inside the input.
/// - There are `width` weights for each float of the segments.
/// - The output has `channels` floats at every output row, which no other thread uses.
/// - Biases and slopes have at least `width` floats.
impl Task for Product<'_> {
    #[inline(always)]
    unsafe fn run<V: Vector>(self) {
        assert!(self.width <= MAX_PANEL && self.channels <= self.width);
        let half = self.width == V::Half::LANES;
        let whole =
            self.width.is_multiple_of(V::LANES) && [1, 2, 4].contains(&(self.width / V::LANES));
        assert!(half || whole);
        assert_eq!(self.rows.len(), self.output_rows.len());
        // SAFETY: passed on to the caller.
        unsafe {
            match self.width / V::LANES {
                0 => multiply::<V::Half, 1>(&self),
                1 => multiply::<V, 1>(&self),
                2 => multiply::<V, 2>(&self),
                _ => multiply::<V, 4>(&self),
            }
        }
    }
}

#[inline(always)]
unsafe fn multiply<V: Vector, const VECTORS: usize>(product: &Product) {
    let width = VECTORS * V::LANES;
    let mut weights = product.weights;
    let last = product.chunks.len().saturating_sub(1);
    for (index, chunk) in product.chunks.iter().enumerate() {
        let first = index == 0;
        let finish = if index == last { product.finish } else { Finish::Keep };
        let length: usize = chunk.iter().map(|segment| segment.length).sum();
        // SAFETY: there are `width` weights for each float of the segments.
        let next = unsafe { weights.add(length * width) };
        let mut row = 0;
        let tiles = product.rows.len().div_ceil(TILE_ROWS);
        for tile in 0..tiles {
            // Distribute the rows evenly: 13 are 5 + 4 + 4, not 6 + 6 + 1.
            let rows = (product.rows.len() - row).div_ceil(tiles - tile);
            // The first tiles fetch the next chunk, one cache line per step along the depth.
            let fetched = tile * length * LINE;
            let ahead = if fetched < length * width {
                Ahead { start: next.wrapping_add(fetched), step: LINE }
            } else {
                Ahead { start: weights, step: 0 }
            };
            let step = Step { row, chunk, weights, ahead, first, finish };
            // SAFETY: `row + rows` is at most the number of rows.
            unsafe {
                match rows {
                    1 => tile_of::<V, 1, VECTORS>(product, step),
                    2 => tile_of::<V, 2, VECTORS>(product, step),
                    3 => tile_of::<V, 3, VECTORS>(product, step),
                    4 => tile_of::<V, 4, VECTORS>(product, step),
                    5 => tile_of::<V, 5, VECTORS>(product, step),
                    _ => tile_of::<V, 6, VECTORS>(product, step),
                }
            }
            row += rows;
        }
        weights = next;
    }
}

/// Floats of a cache line.
const LINE: usize = 16;

/// Weights to fetch into the cache in advance.
#[derive(Clone, Copy)]
struct Ahead {
    start: *const f32,
    /// Floats from one fetch to the next.
    step: usize,
}

/// One chunk of the depth for one tile.
#[derive(Clone, Copy)]
struct Step<'a> {
    /// The tile's first pixel.
    row: usize,
    chunk: &'a [Segment],
    /// The chunk's weights.
    weights: *const f32,
    ahead: Ahead,
    /// True if the chunk is the first of the depth.
    first: bool,
    /// The function that is applied to the sums in this step.
    finish: Finish<'a>,
}

/// Computes `ROWS` pixels from `row` on.
#[inline(always)]
unsafe fn tile_of<V: Vector, const ROWS: usize, const VECTORS: usize>(
    product: &Product,
    step: Step,
) {
    let row = step.row;
    // SAFETY: the caller gives `ROWS` rows from `row` on, and pointers as `Product` requires.
    unsafe {
        let input: [*const f32; ROWS] =
            std::array::from_fn(|r| product.input.add(*product.rows.get_unchecked(row + r)));
        let output: [*mut f32; ROWS] = std::array::from_fn(|r| {
            product.output.add(*product.output_rows.get_unchecked(row + r))
        });
        let (bias, add) = match product.beside {
            _ if !step.first => (None, true),
            Beside::Nothing => (None, false),
            Beside::Bias(bias) => (Some(bias.as_ptr()), false),
            Beside::BiasAndOutput(bias) => (Some(bias.as_ptr()), true),
        };
        tile::<V, ROWS, VECTORS>(input, output, product.channels, step, bias, add);
    }
}

/// Loads the first `count` lanes from memory. The others are zero.
#[inline(always)]
unsafe fn load_first<V: Vector>(from: *const f32, count: usize) -> V {
    // SAFETY: the caller gives as many floats.
    unsafe {
        if count >= V::LANES {
            return V::load(from);
        }
        let mut lanes = [0.0; LINE];
        std::ptr::copy_nonoverlapping(from, lanes.as_mut_ptr(), count);
        V::load(lanes.as_ptr())
    }
}

/// Stores the first `count` lanes to memory.
#[inline(always)]
unsafe fn store_first<V: Vector>(value: V, to: *mut f32, count: usize) {
    // SAFETY: the caller gives room for as many floats.
    unsafe {
        if count >= V::LANES {
            return value.store(to);
        }
        let mut lanes = [0.0; LINE];
        value.store(lanes.as_mut_ptr());
        std::ptr::copy_nonoverlapping(lanes.as_ptr(), to, count);
    }
}

/// Computes the register tile: `ROWS` pixels × `VECTORS` registers of channels, of which the first
/// `channels` exist.
///
/// The output's previous value is added last. Products that are added to a large one lose more of
/// their last digits.
#[inline(always)]
unsafe fn tile<V: Vector, const ROWS: usize, const VECTORS: usize>(
    input: [*const f32; ROWS],
    output: [*mut f32; ROWS],
    channels: usize,
    step: Step,
    bias: Option<*const f32>,
    add: bool,
) {
    let mut weights = step.weights;
    let mut ahead = step.ahead.start;
    // SAFETY: all pointers are as `Product` requires, and stay within its rows and panel.
    unsafe {
        let mut sums = [[V::splat(0.0); VECTORS]; ROWS];
        for segment in step.chunk {
            let input = input.map(|row| row.add(segment.offset));
            for k in 0..segment.length {
                let panel: [V; VECTORS] =
                    std::array::from_fn(|v| V::load(weights.add(v * V::LANES)));
                for (sums, row) in sums.iter_mut().zip(input) {
                    let value = V::splat(*row.add(k));
                    for (sum, weight) in sums.iter_mut().zip(panel) {
                        *sum = value.mul_add(weight, *sum);
                    }
                }
                weights = weights.add(VECTORS * V::LANES);
                prefetch(ahead);
                ahead = ahead.wrapping_add(step.ahead.step);
            }
        }
        if let Some(bias) = bias {
            for v in 0..VECTORS {
                let bias = V::load(bias.add(v * V::LANES));
                for sums in &mut sums {
                    sums[v] = sums[v].add(bias);
                }
            }
        }
        for (sums, output) in sums.into_iter().zip(output) {
            for (v, sum) in sums.into_iter().enumerate() {
                let first = v * V::LANES;
                if first < channels {
                    let (output, count) = (output.add(first), channels - first);
                    let sum = if add { sum.add(load_first(output, count)) } else { sum };
                    store_first(step.finish.apply(sum, first), output, count);
                }
            }
        }
    }
}
