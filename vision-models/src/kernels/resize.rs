//! Bilinear interpolation between the four nearest pixels.

use crate::layout::{Channels, offset, position};

use super::direct::share;
use super::isa::{InstructionSet, Task};
use super::shared_slice::SharedSlice;
use super::threads::Pool;
use super::vector::Vector;

/// Alignment of a resized activation's pixels with the input.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Alignment {
    /// Pixels are areas whose outermost edges coincide, as in PyTorch and OpenCV.
    #[default]
    Edges,
    /// The centres of the first pixels coincide, as in early TensorFlow.
    FirstPixels,
    /// The centres of the first and of the last pixels coincide: `align_corners`.
    OuterPixels,
}

/// The two neighbours of a position along an axis, and its distance from the first.
#[derive(Clone, Copy, Debug)]
struct Place {
    first: usize,
    second: usize,
    fraction: f32,
}

impl Alignment {
    /// Returns the positions of all pixels along an axis.
    #[expect(clippy::cast_possible_truncation, reason = "fractions are f32")]
    #[expect(clippy::cast_sign_loss, reason = "a place is inside the input")]
    fn places(self, from: usize, to: usize) -> Vec<Place> {
        let scale = match self {
            Self::OuterPixels if to > 1 => (from - 1) as f32 / (to - 1) as f32,
            _ => from as f32 / to as f32,
        };
        let place = |index: usize| {
            let place = match self {
                Self::Edges => ((index as f32 + 0.5) * scale - 0.5).max(0.0),
                Self::FirstPixels | Self::OuterPixels => index as f32 * scale,
            };
            let first = (place as usize).min(from - 1);
            let second = (first + 1).min(from - 1);
            Place { first, second, fraction: place - first as f32 }
        };
        (0..to).map(place).collect()
    }
}

/// The interpolation of each channel to other rows and columns.
#[derive(Clone, Debug)]
pub(crate) struct Resize {
    isa: InstructionSet,
    from: Channels,
    to: Channels,
    rows: Vec<Place>,
    columns: Vec<Place>,
}

impl Resize {
    /// Plans the interpolation.
    ///
    /// # Panics
    /// If the numbers of frames or channels differ, or the channels do not exist.
    pub(crate) fn new(
        isa: InstructionSet,
        alignment: Alignment,
        from: Channels,
        to: Channels,
    ) -> Self {
        let (input, output) = (from.layout.size, to.layout.size);
        assert!(from.exist() && to.exist() && from.count == to.count && input[0] == output[0]);
        let [rows, columns] = [1, 2].map(|axis| alignment.places(input[axis], output[axis]));
        Self { isa, from, to, rows, columns }
    }

    /// Runs the interpolation.
    ///
    /// # Panics
    /// If a slice is shorter than its layout.
    pub(crate) fn run(&self, pool: &mut Pool, input: &[f32], output: &mut [f32]) {
        let Self { isa, from, to, rows, columns } = self;
        assert!(input.len() >= from.layout.length() && output.len() >= to.layout.length());
        let output = SharedSlice::new(output);
        let lines = to.layout.size[0] * rows.len();
        let tasks = lines.min(8 * pool.lanes());
        pool.run(tasks, &|_, task| {
            for line in share(lines, tasks, task) {
                let [frame, row, _] = position(line * columns.len(), to.layout.size);
                let y = &rows[row];
                let start = |channels: &Channels, row| {
                    channels.origin() + offset([frame, row, 0], channels.layout.strides())
                };
                let [step, next] = [from, to].map(|channels| channels.layout.strides()[2]);
                let reach = |step: usize, pixels: usize| (pixels - 1) * step + from.count;
                let (width, target) = (from.layout.size[2], start(to, row));
                assert!(columns.iter().all(|column| column.first.max(column.second) < width));
                assert!(target + reach(next, columns.len()) <= output.len());
                let [upper, lower] =
                    [y.first, y.second].map(|row| &input[start(from, row)..][..reach(step, width)]);
                let blend = Blend {
                    lines: [upper.as_ptr(), lower.as_ptr()],
                    step,
                    down: y.fraction,
                    columns,
                    channels: from.count,
                    output: output.at(target),
                    next,
                };
                // SAFETY: the columns were checked against both lines, and the target against the
                // output. No other task has this line.
                unsafe { isa.run(blend) };
            }
        });
    }
}

/// A line of the output.
struct Blend<'a> {
    /// The two lines of the input.
    lines: [*const f32; 2],
    /// Floats from one pixel of the input to the next.
    step: usize,
    /// Distance of the position from the first line.
    down: f32,
    columns: &'a [Place],
    channels: usize,
    output: *mut f32,
    /// Floats from one pixel of the output to the next.
    next: usize,
}

/// Requires that all channels of all columns' pixels lie inside both lines, and those of the
/// output's pixels inside the output.
impl Task for Blend<'_> {
    #[inline(always)]
    unsafe fn run<V: Vector>(self) {
        // SAFETY: the caller guarantees all channels of all pixels.
        unsafe {
            for (index, column) in self.columns.iter().enumerate() {
                let whole = self.registers::<V>(index, column, 0);
                let whole = self.registers::<V::Half>(index, column, whole);
                let (first, second) = (self.step * column.first, self.step * column.second);
                for channel in whole..self.channels {
                    let across = |line: *const f32| {
                        let value = *line.add(first + channel);
                        (*line.add(second + channel) - value) * column.fraction + value
                    };
                    let [above, below] = self.lines.map(across);
                    *self.output.add(index * self.next + channel) =
                        (below - above) * self.down + above;
                }
            }
        }
    }
}

impl Blend<'_> {
    /// Computes the channels of a column from `first` on that fill whole registers. Returns the
    /// first channel behind them.
    #[inline(always)]
    unsafe fn registers<V: Vector>(&self, index: usize, column: &Place, first: usize) -> usize {
        let end = self.channels - (self.channels - first) % V::LANES;
        // SAFETY: passed on to the caller.
        unsafe {
            let (down, right) = (V::splat(self.down), V::splat(column.fraction));
            let [upper, lower] = self.lines;
            for channel in (first..end).step_by(V::LANES) {
                let [left, next] =
                    [column.first, column.second].map(|pixel| self.step * pixel + channel);
                let across = |line: *const f32| {
                    let value = V::load(line.add(left));
                    V::load(line.add(next)).sub(value).mul_add(right, value)
                };
                let (above, below) = (across(upper), across(lower));
                let value = below.sub(above).mul_add(down, above);
                value.store(self.output.add(index * self.next + channel));
            }
        }
        end
    }
}
