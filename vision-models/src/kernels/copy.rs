//! Channels of one activation, copied into another: a concatenation that cannot be written in place.

use crate::layout::{Channels, offset, position};

use super::direct::share;
use super::shared_slice::SharedSlice;
use super::threads::Pool;

/// A copy for one size.
#[derive(Clone, Debug)]
pub(crate) struct Copy {
    from: Channels,
    to: Channels,
}

impl Copy {
    /// Plans the copy.
    ///
    /// # Panics
    /// If sizes or channels differ, or the channels do not exist.
    pub(crate) fn new(from: Channels, to: Channels) -> Self {
        assert!(from.exist() && to.exist() && from.count == to.count);
        assert_eq!(from.layout.size, to.layout.size);
        Self { from, to }
    }

    /// Runs the copy.
    ///
    /// # Panics
    /// If a slice is shorter than its layout.
    pub(crate) fn run(&self, pool: &mut Pool, input: &[f32], output: &mut [f32]) {
        let Self { from, to } = *self;
        assert!(input.len() >= from.layout.length() && output.len() >= to.layout.length());
        let output = SharedSlice::new(output);
        let size = from.layout.size;
        let pixels = from.layout.pixels();
        let tasks = pixels.min(8 * pool.lanes());
        pool.run(tasks, &|_, task| {
            for pixel in share(pixels, tasks, task) {
                let at = position(pixel, size);
                let source = from.origin() + offset(at, from.layout.strides());
                let target = to.origin() + offset(at, to.layout.strides());
                let source = &input[source..source + from.count];
                assert!(target + to.count <= output.len());
                // SAFETY: the target lies inside the output, as just checked; no other task has this pixel.
                unsafe {
                    std::ptr::copy_nonoverlapping(source.as_ptr(), output.at(target), source.len());
                }
            }
        });
    }
}
