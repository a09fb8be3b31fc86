//! The pixels of the input that give a pixel of the output.

use crate::layout::{Extent, Layout};

/// The window of a convolution or a pooling. Frames come first, then rows and columns. An image is
/// a clip of one frame.
///
/// ```
/// use vision_models::engine::Window;
///
/// // 3 × 3, every other row and column, as in the stem of a residual network.
/// let window = Window { stride: [1, 2, 2], ..Window::same([1, 3, 3]) };
/// assert_eq!(window.output([1, 112, 112]), Some([1, 56, 56]));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Frames, rows and columns of the kernel.
    pub kernel: Extent,
    /// Distance in the input from one output to the next. In a transposed convolution, distance in
    /// the output from one input to the next.
    pub stride: Extent,
    /// Zeros around the input. A transposed convolution instead cuts this much off around the
    /// output.
    pub padding: Extent,
    /// Distance from one tap to the next.
    pub dilation: Extent,
    /// Zeros after the input beyond the padding, or fewer if negative. 1 where TensorFlow's `SAME`
    /// pads by an odd number. Zero for a transposed convolution.
    pub extra: [isize; 3],
}

impl Window {
    /// Creates a window of stride one with a padding that keeps the size, for kernels of odd
    /// lengths.
    pub const fn same(kernel: [usize; 3]) -> Self {
        let [frames, rows, columns] = kernel;
        let padding = [frames / 2, rows / 2, columns / 2];
        Self { kernel, stride: [1; 3], padding, dilation: [1; 3], extra: [0; 3] }
    }

    /// Returns the output's frames, rows and columns for an input's. `None` if the kernel does not
    /// fit, or if the sizes are too large for any memory.
    pub fn output(&self, size: [usize; 3]) -> Option<[usize; 3]> {
        let mut output = [0; 3];
        for axis in 0..3 {
            let padded = size[axis].checked_add(self.padding[axis].checked_mul(2)?)?;
            let padded = padded.checked_add_signed(self.extra[axis])?;
            let room = padded.checked_sub(self.span(axis)?)?;
            output[axis] = room.checked_div(self.stride[axis])?.checked_add(1)?;
        }
        Some(output)
    }

    /// Returns the output's frames, rows and columns of a transposed convolution. `None` if there
    /// is no such size.
    pub fn transposed_output(&self, size: [usize; 3]) -> Option<[usize; 3]> {
        let mut output = [0; 3];
        for axis in 0..3 {
            let last = size[axis].checked_sub(1)?.checked_mul(self.stride[axis])?;
            let whole = last.checked_add(self.span(axis)?)?;
            output[axis] = whole.checked_sub(self.padding[axis].checked_mul(2)?)?;
        }
        Some(output)
    }

    /// Returns true if every window has a tap inside the input along an axis, as a pooling needs.
    pub(crate) fn stays_inside(&self, axis: usize) -> bool {
        let (kernel, padding) = (self.kernel[axis], self.padding[axis]);
        let behind = padding.checked_add_signed(self.extra[axis]);
        2 * padding <= kernel && behind.is_none_or(|behind| behind < kernel)
    }

    /// Returns the length from the first tap to the last, both included.
    fn span(&self, axis: usize) -> Option<usize> {
        self.kernel[axis].checked_sub(1)?.checked_mul(self.dilation[axis])?.checked_add(1)
    }

    /// Returns the single phase of a convolution, with every output.
    pub(crate) fn whole(&self, output: Extent) -> Phase {
        let taps = [0, 1, 2].map(|axis| {
            let place = |kernel: usize| Tap {
                kernel,
                offset: (kernel * self.dilation[axis]).cast_signed()
                    - self.padding[axis].cast_signed(),
            };
            (0..self.kernel[axis]).map(place).collect()
        });
        let (start, step) = ([0; 3], [1; 3]);
        Phase { size: output, start, step, input_step: self.stride, taps }
    }

    /// Returns the phases of a transposed convolution. Outputs at distances of the stride see the
    /// same taps. Each phase is therefore a convolution of stride one whose outputs are spread.
    ///
    /// If the stride is s and the padding p, output o gets tap t of input i where s i + d t − p =
    /// o.
    pub(crate) fn phases(&self, output: Extent) -> Vec<Phase> {
        let count: usize = self.stride.iter().product();
        let phase = |index: usize| {
            let [_, rows, columns] = self.stride;
            let start = [index / (rows * columns), index / columns % rows, index % columns];
            let size = std::array::from_fn(|axis| {
                output[axis].saturating_sub(start[axis]).div_ceil(self.stride[axis])
            });
            let taps = [0, 1, 2].map(|axis| {
                let stride = self.stride[axis].cast_signed();
                let mut taps: Vec<Tap> = (0..self.kernel[axis])
                    .filter_map(|kernel| {
                        let tap = (kernel * self.dilation[axis]).cast_signed();
                        let ahead = (start[axis] + self.padding[axis]).cast_signed() - tap;
                        let offset = ahead / stride;
                        (ahead % stride == 0).then_some(Tap { kernel, offset })
                    })
                    .collect();
                taps.sort_by_key(|tap| tap.offset);
                taps
            });
            Phase { size, start, step: self.stride, input_step: [1; 3], taps }
        };
        (0..count).map(phase).collect()
    }
}

/// A tap of a kernel along one axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Tap {
    /// Index in the kernel.
    pub(crate) kernel: usize,
    /// Offset from the start of the output's input.
    pub(crate) offset: isize,
}

/// The outputs that see the same taps.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Phase {
    /// Number of outputs along each axis.
    pub(crate) size: Extent,
    /// The first output.
    pub(crate) start: Extent,
    /// Distance from one output to the next.
    pub(crate) step: Extent,
    /// Distance from one output's input to the next one's.
    pub(crate) input_step: Extent,
    /// The taps along each axis.
    pub(crate) taps: [Vec<Tap>; 3],
}

impl Phase {
    /// Returns the index in the kernel of every tap, columns running fastest.
    pub(crate) fn kernel_taps(&self, [_, rows, columns]: Extent) -> Vec<usize> {
        let [frame_taps, row_taps, column_taps] = &self.taps;
        let mut indices = Vec::with_capacity(frame_taps.len() * row_taps.len() * column_taps.len());
        for frame in frame_taps {
            for row in row_taps {
                for column in column_taps {
                    indices.push((frame.kernel * rows + row.kernel) * columns + column.kernel);
                }
            }
        }
        indices
    }

    /// Returns the zeros that an input of this size needs before and after.
    pub(crate) fn border(&self, size: Extent) -> [Extent; 2] {
        let before = std::array::from_fn(|axis| {
            let first = self.taps[axis].iter().map(|tap| tap.offset).min().unwrap_or(0);
            first.min(0).unsigned_abs()
        });
        let after = std::array::from_fn(|axis| {
            let last = self.taps[axis].iter().map(|tap| tap.offset).max().unwrap_or(0);
            let start = (self.size[axis].saturating_sub(1) * self.input_step[axis]).cast_signed();
            usize::try_from(start + last + 1 - size[axis].cast_signed()).unwrap_or(0)
        });
        [before, after]
    }

    /// Returns true if the outputs lie inside an output of this size, and their taps inside the
    /// input with its border.
    pub(super) fn fits(&self, input: &Layout, output: &Layout) -> bool {
        let [before, after] = self.border(input.size);
        let inside = |axis: usize| {
            let last = self.start[axis] + self.size[axis].saturating_sub(1) * self.step[axis];
            self.size[axis] == 0 || last < output.size[axis]
        };
        input.has_border_of(before, after) && (0..3).all(inside)
    }
}
