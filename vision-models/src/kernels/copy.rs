//! Copies channels of one activation into another: for a concatenation that cannot be written in
//! place, or to reshape.

use crate::layout::{Channels, offset, position};

use super::direct::share;
use super::shared_slice::SharedSlice;
use super::threads::Pool;

/// A copy for one size.
#[derive(Clone, Debug)]
pub(crate) struct Copy {
    from: Channels,
    to: Channels,
    /// Number of floats that are contiguous in both.
    run: usize,
}

impl Copy {
    /// Plans the copy. Elements keep their order: frames, rows, columns, channels, the last fastest.
    ///
    /// # Panics
    /// If the numbers of elements differ, or the channels do not exist.
    pub(crate) fn new(from: Channels, to: Channels) -> Self {
        assert!(from.exist() && to.exist());
        assert_eq!(from.layout.pixels() * from.count, to.layout.pixels() * to.count);
        let (mut run, mut rest) = (from.count, to.count);
        while rest > 0 {
            (run, rest) = (rest, run % rest);
        }
        Self { from, to, run }
    }

    /// Runs the copy.
    ///
    /// # Panics
    /// If a slice is shorter than its layout.
    pub(crate) fn run(&self, pool: &mut Pool, input: &[f32], output: &mut [f32]) {
        let Self { from, to, run } = *self;
        assert!(input.len() >= from.layout.length() && output.len() >= to.layout.length());
        let output = SharedSlice::new(output);
        let runs = from.layout.pixels() * from.count / run;
        let place = |channels: &Channels, at: usize| {
            let pixel = position(at / channels.count, channels.layout.size);
            channels.origin() + offset(pixel, channels.layout.strides()) + at % channels.count
        };
        let tasks = runs.min(8 * pool.lanes());
        pool.run(tasks, &|_, task| {
            for index in share(runs, tasks, task) {
                let (source, target) = (place(&from, index * run), place(&to, index * run));
                let source = &input[source..source + run];
                assert!(target + run <= output.len());
                // SAFETY: the target lies inside the output, as just checked. No other task has
                // this run.
                unsafe {
                    std::ptr::copy_nonoverlapping(source.as_ptr(), output.at(target), source.len());
                }
            }
        });
    }
}
