//! Pooling: the largest value of each window.

use std::ops::Range;

use crate::layout::{Channels, Extent, offset, position};

use super::direct::share;
use super::isa::{InstructionSet, Task};
use super::shared_slice::SharedSlice;
use super::threads::Pool;
use super::vector::Vector;
use super::window::Window;

/// The largest value of each window's part inside the input. A window with NaN or infinity gives
/// NaN.
#[derive(Clone, Debug)]
pub(crate) struct MaxPool {
    isa: InstructionSet,
    window: Window,
    from: Channels,
    to: Channels,
}

impl MaxPool {
    /// Plans the pooling.
    ///
    /// # Panics
    /// - If the output's size is not the one that the window gives.
    /// - If the channels do not exist, or input and output have different numbers of them.
    /// - If a window can lie outside the input: it is dilated, or its padding is too large. The
    ///   padding must be at most half the kernel, and at the end less than the kernel.
    pub(crate) fn new(isa: InstructionSet, window: Window, from: Channels, to: Channels) -> Self {
        assert_eq!(
            window.output(from.layout.size),
            Some(to.layout.size),
            "{window:?} over {from:?}"
        );
        assert!(from.exist() && to.exist() && to.count == from.count);
        assert!((0..3).all(|axis| window.stays_inside(axis)));
        assert_eq!(window.dilation, [1; 3]);
        Self { isa, window, from, to }
    }

    /// Runs the pooling.
    ///
    /// # Panics
    /// If a slice is shorter than its layout.
    pub(crate) fn run(&self, pool: &mut Pool, input: &[f32], output: &mut [f32]) {
        let Self { isa, from, to, .. } = *self;
        let size = to.layout.size;
        let rows = size[0] * size[1];
        assert!(input.len() >= from.layout.length() && output.len() >= to.layout.length());
        let output = SharedSlice::new(output);
        let tasks = rows.min(8 * pool.lanes());
        pool.run(tasks, &|_, task| {
            for row in share(rows, tasks, task) {
                for column in 0..size[2] {
                    let at = position(row * size[2] + column, size);
                    let taps = [0, 1, 2].map(|axis| self.taps(axis, at[axis]));
                    let first = taps.each_ref().map(|taps| taps.start);
                    let strides = from.layout.strides();
                    let maximum = Maximum {
                        input: input[from.origin() + offset(first, strides)..].as_ptr(),
                        extent: taps.map(|taps| taps.len()),
                        strides,
                        channels: from.count,
                        output: output.at(to.origin() + offset(at, to.layout.strides())),
                    };
                    // SAFETY: the taps lie inside the input's layout and the pixel inside the
                    // output's, whose lengths were checked. No other task has this row.
                    unsafe { isa.run(maximum) };
                }
            }
        });
    }

    /// Returns the part of a window that lies inside the input, along one axis.
    fn taps(&self, axis: usize, at: usize) -> Range<usize> {
        let (kernel, padding) = (self.window.kernel[axis], self.window.padding[axis]);
        let start = at * self.window.stride[axis];
        let end = (start + kernel).saturating_sub(padding).min(self.from.layout.size[axis]);
        start.saturating_sub(padding)..end
    }
}

/// The maximum of one window.
struct Maximum {
    /// The window's first pixel.
    input: *const f32,
    /// Frames, rows and columns of the window.
    extent: Extent,
    strides: Extent,
    channels: usize,
    /// The output's pixel.
    output: *mut f32,
}

/// Requires at least one pixel in the window. All its channels, and those of the output's pixel,
/// must lie inside the activations.
impl Task for Maximum {
    #[inline(always)]
    unsafe fn run<V: Vector>(self) {
        let whole = self.channels - self.channels % V::LANES;
        let taps = || {
            let [frames, rows, columns] = self.extent;
            let [frame, row, column] = self.strides;
            (0..frames).flat_map(move |f| {
                (0..rows)
                    .flat_map(move |r| (0..columns).map(move |c| f * frame + r * row + c * column))
            })
        };
        // SAFETY: the caller guarantees all taps and channels.
        unsafe {
            for channel in (0..whole).step_by(V::LANES) {
                let zero = V::splat(0.0);
                let (mut largest, mut overflow) = (V::load(self.input.add(channel)), zero);
                for tap in taps() {
                    let value = V::load(self.input.add(tap + channel));
                    largest = largest.max(value);
                    // Zero, until a value is not finite.
                    overflow = value.mul_add(zero, overflow);
                }
                largest.add(overflow).store(self.output.add(channel));
            }
            for channel in whole..self.channels {
                let values = taps().map(|tap| *self.input.add(tap + channel));
                let start = (*self.input.add(channel), 0.0);
                let (largest, overflow) = values.fold(start, |(most, sum): (f32, f32), value| {
                    (most.max(value), sum + 0.0 * value)
                });
                *self.output.add(channel) = largest + overflow;
            }
        }
    }
}
