//! Bilinear interpolation between the four nearest pixels.

use crate::layout::{Channels, offset, position};

use super::direct::share;
use super::isa::{InstructionSet, Task};
use super::shared_slice::SharedSlice;
use super::threads::Pool;
use super::vector::Vector;

/// Where in the input a pixel of a resized activation lies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Alignment {
    /// Pixels are areas, and the outermost edges lie on each other: PyTorch's and OpenCV's.
    #[default]
    Edges,
    /// The centres of the first pixels lie on each other: TensorFlow's old one.
    FirstPixels,
    /// The centres of the first and of the last pixels lie on each other: `align_corners`.
    OuterPixels,
}

/// The two neighbours of a place along an axis, and how far it is from the first.
#[derive(Clone, Copy, Debug)]
struct Place {
    first: usize,
    second: usize,
    fraction: f32,
}

impl Alignment {
    /// The places of all pixels along an axis.
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
    /// If the frames or the channels are not equally many, or the channels do not exist.
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
                let [step, next] = [from, to].map(|channels| channels.layout.strides()[2]);
                let line = |row| from.origin() + offset([frame, row, 0], from.layout.strides());
                let (upper, lower) = (line(y.first), line(y.second));
                let corner = |line: usize, column: usize| {
                    input[line + column * step..][..from.count].as_ptr()
                };
                let mut target = to.origin() + offset([frame, row, 0], to.layout.strides());
                for column in columns {
                    assert!(target + to.count <= output.len());
                    let blend = Blend {
                        upper: [corner(upper, column.first), corner(upper, column.second)],
                        lower: [corner(lower, column.first), corner(lower, column.second)],
                        fractions: [y.fraction, column.fraction],
                        channels: from.count,
                        output: output.at(target),
                    };
                    // SAFETY: the four pixels and the target were checked against their slices; no other task has
                    // this line.
                    unsafe { isa.run(blend) };
                    target += next;
                }
            }
        });
    }
}

/// One pixel of the output.
struct Blend {
    upper: [*const f32; 2],
    lower: [*const f32; 2],
    /// Of the second row, and of the second column.
    fractions: [f32; 2],
    channels: usize,
    output: *mut f32,
}

/// Asks for: all channels of the four pixels inside the input, and of the output's pixel.
impl Task for Blend {
    #[inline(always)]
    unsafe fn run<V: Vector>(self) {
        let Self { upper, lower, fractions, channels, output } = self;
        let whole = channels - channels % V::LANES;
        // SAFETY: the caller vouches for all channels of all pixels.
        unsafe {
            let [down, right] = fractions.map(|fraction| V::splat(fraction));
            for channel in (0..whole).step_by(V::LANES) {
                let across = |[first, second]: [*const f32; 2]| {
                    let first = V::load(first.add(channel));
                    V::load(second.add(channel)).sub(first).mul_add(right, first)
                };
                let (above, below) = (across(upper), across(lower));
                below.sub(above).mul_add(down, above).store(output.add(channel));
            }
            for channel in whole..channels {
                let across = |[first, second]: [*const f32; 2]| {
                    let first = *first.add(channel);
                    (*second.add(channel) - first) * fractions[1] + first
                };
                let (above, below) = (across(upper), across(lower));
                *output.add(channel) = (below - above) * fractions[0] + above;
            }
        }
    }
}
