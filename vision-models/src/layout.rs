//! How activations lie in memory: frames, rows, pixels, channels, inside a border of zeros.

/// Frames (time), rows (height) and columns (width), in this order.
pub(crate) type Extent = [usize; 3];

/// The layout of one activation tensor, channels running fastest. Its border holds zeros, so that
/// a padded convolution reads past the edges without asking where they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Layout {
    /// Frames, rows and columns, without the border.
    pub(crate) size: Extent,
    /// Floats a pixel.
    pub(crate) channels: usize,
    /// Zeros before the first frame, row and column.
    pub(crate) before: Extent,
    /// Zeros after the last frame, row and column.
    pub(crate) after: Extent,
}

impl Layout {
    /// A layout without a border.
    pub(crate) fn dense(size: Extent, channels: usize) -> Self {
        Self { size, channels, before: [0; 3], after: [0; 3] }
    }

    /// Frames, rows and columns with the border.
    fn padded(&self) -> Extent {
        std::array::from_fn(|axis| self.before[axis] + self.size[axis] + self.after[axis])
    }

    /// Floats from one frame, row and column to the next.
    pub(crate) fn strides(&self) -> Extent {
        let [_, rows, columns] = self.padded();
        [rows * columns * self.channels, columns * self.channels, self.channels]
    }

    /// Floats in all.
    pub(crate) fn length(&self) -> usize {
        self.padded().iter().product::<usize>() * self.channels
    }

    /// The same where it may be more than a slice can have: `None` then. The other methods are for layouts
    /// that can be.
    pub(crate) fn checked_length(&self) -> Option<usize> {
        let axes = (0..3).map(|axis| {
            self.before[axis].checked_add(self.size[axis])?.checked_add(self.after[axis])
        });
        let length = axes
            .chain([Some(self.channels)])
            .try_fold(1_usize, |all, axis| all.checked_mul(axis?))?;
        (length <= isize::MAX as usize / size_of::<f32>()).then_some(length)
    }

    /// Where the first pixel inside the border starts.
    pub(crate) fn origin(&self) -> usize {
        self.strides().iter().zip(&self.before).map(|(stride, before)| stride * before).sum()
    }

    /// Pixels of all frames, without the border.
    pub(crate) fn pixels(&self) -> usize {
        self.size.iter().product()
    }

    /// Whether the border holds anything.
    pub(crate) fn has_border(&self) -> bool {
        self.before != [0; 3] || self.after != [0; 3]
    }

    /// Whether the border is at least this large.
    pub(crate) fn has_border_of(&self, before: Extent, after: Extent) -> bool {
        (0..3).all(|axis| self.before[axis] >= before[axis] && self.after[axis] >= after[axis])
    }

    /// Makes the border zero.
    pub(crate) fn clear_border(&self, memory: &mut [f32]) {
        let strides = self.strides();
        // What lies before and after the part inside, from the whole down to one row.
        let mut clear = |start: usize, axis: usize| {
            let first = start + self.before[axis] * strides[axis];
            let last = first + self.size[axis] * strides[axis];
            memory[start..first].fill(0.0);
            memory[last..last + self.after[axis] * strides[axis]].fill(0.0);
            first
        };
        let frames = clear(0, 0);
        for frame in 0..self.size[0] {
            let rows = clear(frames + frame * strides[0], 1);
            for row in 0..self.size[1] {
                clear(rows + row * strides[1], 2);
            }
        }
    }

    /// Makes the border at least this large.
    pub(crate) fn widen(&mut self, before: Extent, after: Extent) {
        for axis in 0..3 {
            self.before[axis] = self.before[axis].max(before[axis]);
            self.after[axis] = self.after[axis].max(after[axis]);
        }
    }
}

/// Neighbouring channels of an activation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Channels {
    /// The activation's.
    pub(crate) layout: Layout,
    /// The first of the channels.
    pub(crate) first: usize,
    /// How many they are.
    pub(crate) count: usize,
}

impl Channels {
    /// Where the channels of the first pixel inside the border start.
    pub(crate) fn origin(&self) -> usize {
        self.layout.origin() + self.first
    }

    /// Whether the activation has them.
    pub(crate) fn exist(&self) -> bool {
        let end = self.first.checked_add(self.count);
        self.count > 0 && end.is_some_and(|end| end <= self.layout.channels)
    }
}

/// The position of the `index`-th pixel of an extent, columns running fastest.
pub(crate) fn position(index: usize, extent: Extent) -> Extent {
    let [_, rows, columns] = extent;
    [index / (rows * columns), index / columns % rows, index % columns]
}

/// The dot product of a position and strides.
pub(crate) fn offset(position: Extent, strides: Extent) -> usize {
    position.iter().zip(&strides).map(|(at, stride)| at * stride).sum()
}
