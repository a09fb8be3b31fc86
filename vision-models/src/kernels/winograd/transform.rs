//! Bᵀ d B and Aᵀ m A for many tiles, a register of channels at a time.
// The columns of a tile are written through its rows.
#![allow(clippy::needless_range_loop)]

use crate::layout::Extent;

use super::super::{epilogue::Epilogue, isa::Task, vector::Vector};
use super::lines::{Four, Line, Tiling, Two};

/// Transform from activations to the points of some tiles.
#[derive(Clone, Copy, Debug)]
pub(super) struct InputTransform<'a> {
    pub(super) tiling: Tiling,
    /// The activations.
    pub(super) input: *const f32,
    /// Start of each tile's first input pixel.
    pub(super) starts: &'a [usize],
    /// Floats from one frame, row and column to the next.
    pub(super) strides: Extent,
    /// Number of channels, a multiple of 16.
    pub(super) channels: usize,
    /// The first of these tiles at the first point. Tiles are `channels` apart.
    pub(super) points: *mut f32,
    /// Floats from one point to the next.
    pub(super) point_stride: usize,
}

/// Requires that the input of every tile lies inside the activations. There must be room for
/// `channels` floats of every tile at every point, which no other thread uses.
impl Task for InputTransform<'_> {
    #[inline(always)]
    unsafe fn run<V: Vector>(self) {
        assert!(self.channels.is_multiple_of(V::LANES));
        let [frame, row, column] = self.strides;
        // SAFETY: passed on to the caller.
        unsafe {
            match self.tiling {
                Tiling::Two => self.tiles::<V>(|from, to| {
                    plane_input::<V, Two, 4, 2>(from, row, column, to, self.point_stride);
                }),
                Tiling::Four => self.tiles::<V>(|from, to| {
                    plane_input::<V, Four, 6, 4>(from, row, column, to, self.point_stride);
                }),
                Tiling::FourFrames => self.tiles::<V>(|from, to| {
                    let line = std::array::from_fn(|at| V::load(from.add(at * frame)));
                    for (at, value) in Four::input::<V>(line).into_iter().enumerate() {
                        value.store(to.add(at * self.point_stride));
                    }
                }),
            }
        }
    }
}

impl InputTransform<'_> {
    /// Calls `transform(from, to)` for each register of channels of each tile.
    #[inline(always)]
    unsafe fn tiles<V: Vector>(&self, transform: impl Fn(*const f32, *mut f32)) {
        for (tile, &start) in self.starts.iter().enumerate() {
            for channel in (0..self.channels).step_by(V::LANES) {
                // SAFETY: both are inside the tile's input and the tile's points.
                unsafe {
                    transform(
                        self.input.add(start + channel),
                        self.points.add(tile * self.channels + channel),
                    );
                }
            }
        }
    }
}

#[inline(always)]
unsafe fn plane_input<
    V: Vector,
    L: Line<POINTS, OUTPUTS>,
    const POINTS: usize,
    const OUTPUTS: usize,
>(
    from: *const f32,
    row: usize,
    column: usize,
    to: *mut f32,
    point_stride: usize,
) {
    // SAFETY: the caller gives a whole tile, and room at each point.
    unsafe {
        let mut lines = [[V::splat(0.0); POINTS]; POINTS];
        for x in 0..POINTS {
            let line = std::array::from_fn(|y| V::load(from.add(y * row + x * column)));
            for (y, value) in L::input::<V>(line).into_iter().enumerate() {
                lines[y][x] = value;
            }
        }
        for (y, line) in lines.into_iter().enumerate() {
            for (x, value) in L::input::<V>(line).into_iter().enumerate() {
                value.store(to.add((y * POINTS + x) * point_stride));
            }
        }
    }
}

/// A tile's position in the output.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Target {
    /// Start of the tile's first output pixel.
    pub(super) start: usize,
    /// Frames, rows and columns of the tile that exist.
    pub(super) valid: Extent,
}

/// Transform from the points of some tiles to one panel's output.
#[derive(Clone, Copy, Debug)]
pub(super) struct OutputTransform<'a> {
    pub(super) tiling: Tiling,
    /// The first tile at the first point. Tiles are `width` apart.
    pub(super) points: *const f32,
    /// Floats from one point to the next.
    pub(super) point_stride: usize,
    /// Number of channels of the panel, a multiple of 16.
    pub(super) width: usize,
    /// The output position of each tile.
    pub(super) targets: &'a [Target],
    /// Floats from one frame, row and column of the output to the next.
    pub(super) strides: Extent,
    /// The output's first float for the panel's first channel.
    pub(super) output: *mut f32,
    /// The panel's biases.
    pub(super) bias: &'a [f32],
    /// The operations on the sums.
    pub(super) epilogue: Epilogue<'a>,
}

/// Requires `width` floats of every tile at every point, and of every valid pixel of every tile in
/// the output, which no other thread uses. Also requires `width` biases and slopes.
impl Task for OutputTransform<'_> {
    #[inline(always)]
    unsafe fn run<V: Vector>(self) {
        assert!(self.width.is_multiple_of(V::LANES) && self.bias.len() >= self.width);
        // SAFETY: passed on to the caller.
        unsafe {
            match self.tiling {
                Tiling::Two => self.planes::<V, Two, 4, 2>(),
                Tiling::Four => self.planes::<V, Four, 6, 4>(),
                Tiling::FourFrames => self.lines::<V>(),
            }
        }
    }
}

impl OutputTransform<'_> {
    #[inline(always)]
    unsafe fn finish<V: Vector>(&self, value: V, bias: V, channel: usize, to: *mut f32) {
        // SAFETY: passed on to the caller.
        unsafe {
            let value = value.add(bias);
            let value = if self.epilogue.add { value.add(V::load(to)) } else { value };
            self.epilogue.finish.apply(value, channel).store(to);
        }
    }

    #[inline(always)]
    unsafe fn lines<V: Vector>(&self) {
        // SAFETY: the caller guarantees tiles, points and pixels.
        unsafe {
            for (tile, target) in self.targets.iter().enumerate() {
                for channel in (0..self.width).step_by(V::LANES) {
                    let bias = V::load(self.bias.as_ptr().add(channel));
                    let from = self.points.add(tile * self.width + channel);
                    let to = self.output.add(target.start + channel);
                    let line =
                        std::array::from_fn(|point| V::load(from.add(point * self.point_stride)));
                    let values = Four::output::<V>(line);
                    for (t, value) in values.into_iter().enumerate().take(target.valid[0]) {
                        self.finish(value, bias, channel, to.add(t * self.strides[0]));
                    }
                }
            }
        }
    }

    #[inline(always)]
    unsafe fn planes<
        V: Vector,
        L: Line<POINTS, OUTPUTS>,
        const POINTS: usize,
        const OUTPUTS: usize,
    >(
        &self,
    ) {
        let [_, row, column] = self.strides;
        // SAFETY: the caller guarantees tiles, points and pixels.
        unsafe {
            for (tile, target) in self.targets.iter().enumerate() {
                let [_, rows, columns] = target.valid;
                for channel in (0..self.width).step_by(V::LANES) {
                    let bias = V::load(self.bias.as_ptr().add(channel));
                    let from = self.points.add(tile * self.width + channel);
                    let to = self.output.add(target.start + channel);
                    let mut lines = [[V::splat(0.0); POINTS]; OUTPUTS];
                    for x in 0..POINTS {
                        let line = std::array::from_fn(|y| {
                            V::load(from.add((y * POINTS + x) * self.point_stride))
                        });
                        for (y, value) in L::output::<V>(line).into_iter().enumerate() {
                            lines[y][x] = value;
                        }
                    }
                    for (y, line) in lines.into_iter().enumerate().take(rows) {
                        let values = L::output::<V>(line);
                        for (x, value) in values.into_iter().enumerate().take(columns) {
                            self.finish(value, bias, channel, to.add(y * row + x * column));
                        }
                    }
                }
            }
        }
    }
}
