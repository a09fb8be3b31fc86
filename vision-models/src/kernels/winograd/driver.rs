//! A whole layer: divides the tiles among the threads.

use crate::layout::{Channels, Extent, offset, position};

use super::super::{
    buffer::Buffer,
    direct::{Operands, share},
    epilogue::{Epilogue, Finish},
    isa::InstructionSet,
    pack::{Panels, pack},
    product::{Beside, Product, Segment},
    shared_slice::SharedSlice,
    threads::Pool,
};
use super::lines::Tiling;
use super::transform::{InputTransform, OutputTransform, Target};

/// Largest number of tiles that are processed together.
const MAX_TILES: usize = 256;
/// Floats of a block's points that a thread keeps in its second-level cache.
const CACHED_POINTS: usize = 160 * 1024;
/// Floats of a block's points if all threads share a block.
const SHARED_POINTS: usize = 1200 * 1024;
/// Offset that keeps the points of one tile out of each other's cache sets.
const SKEW: usize = 16;

/// A convolution by tiles for one input size, without its weights.
#[derive(Clone, Debug)]
pub(crate) struct Winograd {
    isa: InstructionSet,
    panels: Panels,
    tiling: Tiling,
    input: Channels,
    output: Channels,
    origin: usize,
    /// The only chunk of the products: a tile's channels.
    chunks: Vec<Vec<Segment>>,
    blocks: usize,
    /// Number of tiles of the largest block.
    block: usize,
    /// True if the threads share each block (divided by panels). False if each has its own blocks.
    cooperative: bool,
}

impl Winograd {
    /// Plans a convolution with padding that keeps the size.
    ///
    /// # Panics
    /// - If the sizes differ.
    /// - If the input's border is less than half the kernel before, or than [`Tiling::after`]
    ///   after.
    /// - If there are groups.
    /// - If the channels do not exist, are not a multiple of 16, or are not those of the panels.
    pub(crate) fn new(
        isa: InstructionSet,
        panels: Panels,
        tiling: Tiling,
        input: Channels,
        output: Channels,
        lanes: usize,
    ) -> Self {
        let (inputs, from, size) = (input.count, input.layout, output.layout.size);
        assert_eq!(from.size, size, "the padding keeps the size");
        assert!(input.exist() && output.exist() && inputs.is_multiple_of(16));
        assert!(panels.groups == 1 && panels.padded() == output.count, "whole panels");
        let padding = tiling.kernel().map(|taps| taps / 2);
        assert!(from.has_border_of(padding, tiling.after(size)));
        let before: Extent = std::array::from_fn(|axis| from.before[axis] - padding[axis]);
        let tiles: usize = tiling.tiles(size).iter().product();
        let tile_points = tiling.points() * inputs;
        // A thread has its own blocks if the weights are small compared with the activations.
        let own = (CACHED_POINTS / tile_points).clamp(1, MAX_TILES);
        let own_blocks = tiles.div_ceil(own).next_multiple_of(lanes).min(tiles);
        let cooperative = panels.channels >= tiles.div_ceil(own_blocks) * 6;
        let blocks = if cooperative {
            tiles.div_ceil((SHARED_POINTS / tile_points).clamp(1, MAX_TILES))
        } else {
            own_blocks
        };
        Self {
            isa,
            panels,
            tiling,
            input,
            output,
            origin: offset(before, from.strides()) + input.first,
            chunks: vec![vec![Segment { offset: 0, length: inputs }]],
            blocks,
            block: tiles.div_ceil(blocks),
            cooperative,
        }
    }

    /// Returns G g Gᵀ of all kernels, panel by panel, point by point. `taps(output, input, taps)`
    /// gives one kernel.
    pub(crate) fn pack(
        panels: Panels,
        tiling: Tiling,
        inputs: usize,
        taps: impl Fn(usize, usize, &mut [f64]),
    ) -> Buffer {
        let mut kernel = vec![0.0; tiling.kernel().iter().product()];
        let mut values = vec![0.0; tiling.points()];
        pack(panels, tiling.points() * inputs, |output, column| {
            for input in 0..inputs {
                taps(output, input, &mut kernel);
                tiling.kernel_points(&kernel, &mut values);
                for (point, &value) in values.iter().enumerate() {
                    #[expect(clippy::cast_possible_truncation, reason = "the weights are f32")]
                    let value = value as f32;
                    column[point * inputs + input] = value;
                }
            }
        })
    }

    fn point_stride(&self) -> usize {
        self.block * self.input.count + SKEW
    }

    fn panel_stride(&self) -> usize {
        self.block * self.panels.width + SKEW
    }

    /// Returns the number of floats of scratch memory that [`Self::run`] needs.
    pub(crate) fn scratch(&self, lanes: usize) -> usize {
        let points = self.tiling.points();
        let inputs = points * self.point_stride();
        let inputs = if self.cooperative { inputs } else { inputs * lanes };
        inputs + lanes * points * self.panel_stride()
    }

    /// Runs the convolution.
    ///
    /// # Panics
    /// If a slice is shorter than its layout or [`Self::scratch`].
    pub(crate) fn run(
        &self,
        pool: &mut Pool,
        Operands { input, weights, bias }: Operands<'_>,
        output: &mut [f32],
        scratch: &mut [f32],
        epilogue: Epilogue<'_>,
    ) {
        let panels = self.panels;
        assert!(input.len() >= self.input.layout.length());
        assert!(output.len() >= self.output.layout.length());
        assert!(scratch.len() >= self.scratch(pool.lanes()));
        assert!(weights.len() >= panels.padded() * self.input.count * self.tiling.points());
        assert!(bias.len() >= panels.padded() && epilogue.finish.has_slopes(panels.padded()));
        let inputs = self.tiling.points() * self.point_stride();
        let sums = self.tiling.points() * self.panel_stride();
        let input_points = if self.cooperative { inputs } else { inputs * pool.lanes() };
        let (input_points, sum_points) = scratch.split_at_mut(input_points);
        let (input_points, sum_points) =
            (SharedSlice::new(input_points), SharedSlice::new(sum_points));
        let layer =
            Layer { plan: self, input, weights, bias, output: SharedSlice::new(output), epilogue };
        let tiles: usize = self.tiling.tiles(self.output.layout.size).iter().product();
        let lanes = pool.lanes();
        if self.cooperative {
            for block in 0..self.blocks {
                let tiles = share(tiles, self.blocks, block);
                let parts = (4 * lanes).min(tiles.len());
                pool.run(parts, &|_, part| {
                    let mine = share(tiles.len(), parts, part);
                    let points = input_points.at(mine.start * self.input.count);
                    // SAFETY: the scratch memory has room for a whole block. Each part has its own
                    // tiles.
                    unsafe {
                        layer.transform(tiles.start + mine.start..tiles.start + mine.end, points);
                    }
                });
                pool.run(panels.count(), &|lane, panel| {
                    let sums = sum_points.at(lane * sums);
                    // SAFETY: the points are complete. Each lane has its own sums, and each task
                    // its own panel.
                    unsafe { layer.multiply(tiles.clone(), panel, input_points.at(0), sums) };
                });
            }
        } else {
            pool.run(self.blocks, &|lane, block| {
                let tiles = share(tiles, self.blocks, block);
                let points = input_points.at(lane * inputs);
                // SAFETY: each lane has its own points and sums, and each task its own tiles.
                unsafe {
                    layer.transform(tiles.clone(), points);
                    for panel in 0..panels.count() {
                        layer.multiply(tiles.clone(), panel, points, sum_points.at(lane * sums));
                    }
                }
            });
        }
    }
}

/// A layer with its operands.
struct Layer<'a> {
    plan: &'a Winograd,
    input: &'a [f32],
    weights: &'a [f32],
    bias: &'a [f32],
    output: SharedSlice<'a>,
    epilogue: Epilogue<'a>,
}

impl Layer<'_> {
    /// Returns the position of a tile's first output pixel.
    fn tile(&self, tile: usize) -> Extent {
        let outputs = self.plan.tiling.outputs();
        let at = position(tile, self.plan.tiling.tiles(self.plan.output.layout.size));
        std::array::from_fn(|axis| at[axis] * outputs[axis])
    }

    /// # Safety
    /// `points` must have room for these tiles at every point, and no other thread may use it.
    unsafe fn transform(&self, tiles: std::ops::Range<usize>, points: *mut f32) {
        let plan = self.plan;
        let strides = plan.input.layout.strides();
        let outputs = plan.tiling.outputs();
        let kernel = plan.tiling.kernel();
        let last = std::array::from_fn(|axis| outputs[axis] + kernel[axis] - 2);
        let reach = offset(last, strides) + plan.input.count;
        let mut starts = [0; MAX_TILES];
        let starts = &mut starts[..tiles.len()];
        for (start, tile) in starts.iter_mut().zip(tiles) {
            *start = plan.origin + offset(self.tile(tile), strides);
            assert!(*start + reach <= self.input.len());
        }
        let transform = InputTransform {
            tiling: plan.tiling,
            input: self.input.as_ptr(),
            starts,
            strides,
            channels: plan.input.count,
            points,
            point_stride: plan.point_stride(),
        };
        // SAFETY: every tile's reach was checked. The rest is passed on to the caller.
        unsafe { plan.isa.run(transform) };
    }

    /// # Safety
    /// `points` must hold these tiles. `sums` must have room for a panel's sums of these tiles. No
    /// other thread may use `sums`, or this panel of these tiles in the output.
    unsafe fn multiply(
        &self,
        tiles: std::ops::Range<usize>,
        panel: usize,
        points: *mut f32,
        sums: *mut f32,
    ) {
        let plan = self.plan;
        let (width, channels) = (plan.panels.width, plan.input.count);
        let mut rows = [0; MAX_TILES];
        let mut sum_rows = [0; MAX_TILES];
        let mut targets = [Target::default(); MAX_TILES];
        let count = tiles.len();
        let outputs = plan.tiling.outputs();
        for (index, tile) in tiles.enumerate() {
            rows[index] = index * channels;
            sum_rows[index] = index * width;
            let at = self.tile(tile);
            targets[index] = Target {
                start: plan.output.origin() + offset(at, plan.output.layout.strides()),
                valid: std::array::from_fn(|axis| {
                    outputs[axis].min(plan.output.layout.size[axis] - at[axis])
                }),
            };
        }
        let point_weights = channels * width;
        let weights = &self.weights[panel * plan.tiling.points() * point_weights..];
        for point in 0..plan.tiling.points() {
            let product = Product {
                // SAFETY: the caller's points cover all points of the tiling.
                input: unsafe { points.add(point * plan.point_stride()) },
                rows: &rows[..count],
                chunks: &plan.chunks,
                weights: weights[point * point_weights..][..point_weights].as_ptr(),
                width,
                channels: width,
                // SAFETY: as above.
                output: unsafe { sums.add(point * plan.panel_stride()) },
                output_rows: &sum_rows[..count],
                beside: Beside::Nothing,
                finish: Finish::Keep,
            };
            // SAFETY: passed on to the caller.
            unsafe { plan.isa.run(product) };
        }
        let transform = OutputTransform {
            tiling: plan.tiling,
            points: sums,
            point_stride: plan.panel_stride(),
            width,
            targets: &targets[..count],
            strides: plan.output.layout.strides(),
            output: self.output.at(panel * width),
            bias: &self.bias[panel * width..][..width],
            epilogue: Epilogue {
                finish: self.epilogue.finish.of_panel(panel * width, width),
                ..self.epilogue
            },
        };
        // SAFETY: the targets' valid pixels lie inside the output's layout, whose length was
        // checked, and the panel inside its channels; the rest is passed on to the caller.
        unsafe { plan.isa.run(transform) };
    }
}
