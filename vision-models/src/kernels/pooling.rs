//! Pooling: the largest value of each window.

use std::ops::Range;

use crate::layout::{Extent, Layout, offset, position};

use super::direct::{Window, share};
use super::isa::{InstructionSet, Task};
use super::shared_slice::SharedSlice;
use super::threads::Pool;
use super::vector::Vector;

/// The largest value of each window, behind a ReLU: the part of a window outside the input counts
/// as zeros, and nothing is smaller. A window with NaN gives NaN.
#[derive(Clone, Debug)]
pub(crate) struct MaxPool {
    isa: InstructionSet,
    window: Window,
    from: Layout,
    to: Layout,
}

impl MaxPool {
    /// Plans the pooling of `from` into the first channels of `to`.
    ///
    /// # Panics
    /// If `to` has another size than the window gives, or too few channels.
    pub(crate) fn new(isa: InstructionSet, window: Window, from: Layout, to: Layout) -> Self {
        assert_eq!(window.output(from.size), Some(to.size), "{window:?} over {from:?}");
        assert!(to.channels >= from.channels);
        Self { isa, window, from, to }
    }

    /// Runs the pooling.
    ///
    /// # Panics
    /// If a slice is shorter than its layout.
    pub(crate) fn run(&self, pool: &mut Pool, input: &[f32], output: &mut [f32]) {
        let Self { isa, from, to, .. } = *self;
        let rows = to.size[0] * to.size[1];
        assert!(input.len() >= from.length() && output.len() >= to.length());
        let output = SharedSlice::new(output);
        let tasks = rows.min(8 * pool.lanes());
        pool.run(tasks, &|_, task| {
            for row in share(rows, tasks, task) {
                for column in 0..to.size[2] {
                    let at = position(row * to.size[2] + column, to.size);
                    let taps = [0, 1, 2].map(|axis| self.taps(axis, at[axis]));
                    let first = taps.each_ref().map(|taps| taps.start);
                    let maximum = Maximum {
                        input: input[from.origin() + offset(first, from.strides())..].as_ptr(),
                        extent: taps.map(|taps| taps.len()),
                        strides: from.strides(),
                        channels: from.channels,
                        output: output.at(to.origin() + offset(at, to.strides())),
                    };
                    // SAFETY: the taps lie inside the input's layout and the pixel inside the
                    // output's, whose lengths were checked; no other task has this row.
                    unsafe { isa.run(maximum) };
                }
            }
        });
    }

    /// The part of a window that lies inside the input, along one axis.
    fn taps(&self, axis: usize, at: usize) -> Range<usize> {
        let (kernel, padding) = (self.window.kernel[axis], self.window.padding[axis]);
        let start = at * self.window.stride[axis];
        let end = (start + kernel).saturating_sub(padding).min(self.from.size[axis]);
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

/// Asks for: all channels of all pixels of the window inside the input, and of the output's pixel.
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
        // SAFETY: the caller vouches for all taps and channels.
        unsafe {
            for channel in (0..whole).step_by(V::LANES) {
                let zero = V::splat(0.0);
                let (mut largest, mut overflow) = (zero, zero);
                for tap in taps() {
                    let value = V::load(self.input.add(tap + channel));
                    largest = largest.max(value);
                    // Zero, until a value is NaN.
                    overflow = value.mul_add(zero, overflow);
                }
                largest.add(overflow).store(self.output.add(channel));
            }
            for channel in whole..self.channels {
                let values = taps().map(|tap| *self.input.add(tap + channel));
                let (largest, overflow) = values.fold((0.0_f32, 0.0), |(most, sum), value| {
                    (most.max(value), sum + 0.0 * value)
                });
                *self.output.add(channel) = largest + overflow;
            }
        }
    }
}
