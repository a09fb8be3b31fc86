//! Memory layout of activations: frames, rows, pixels, channels, inside a border of zeros.

/// Frames (time), rows (height) and columns (width), in this order.
pub(crate) type Extent = [usize; 3];

/// The layout of one activation tensor, channels running fastest. Its border holds zeros, so that a
/// padded convolution can read past the edges without checks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Layout {
    /// Frames, rows and columns, without the border.
    pub(crate) size: Extent,
    /// Floats per pixel.
    pub(crate) channels: usize,
    /// Zeros before the first frame, row and column.
    pub(crate) before: Extent,
    /// Zeros after the last frame, row and column.
    pub(crate) after: Extent,
}

impl Layout {
    /// Creates a layout without a border.
    pub(crate) fn dense(size: Extent, channels: usize) -> Self {
        Self { size, channels, before: [0; 3], after: [0; 3] }
    }

    /// Returns frames, rows and columns with the border.
    fn padded(&self) -> Extent {
        std::array::from_fn(|axis| self.before[axis] + self.size[axis] + self.after[axis])
    }

    /// Returns the floats from one frame, row and column to the next.
    pub(crate) fn strides(&self) -> Extent {
        let [_, rows, columns] = self.padded();
        [rows * columns * self.channels, columns * self.channels, self.channels]
    }

    /// Returns the total number of floats.
    pub(crate) fn length(&self) -> usize {
        self.padded().iter().product::<usize>() * self.channels
    }

    /// Returns the same, or `None` if it exceeds the size of any slice. The other methods require a
    /// layout that does not.
    pub(crate) fn checked_length(&self) -> Option<usize> {
        let axes = (0..3).map(|axis| {
            self.before[axis].checked_add(self.size[axis])?.checked_add(self.after[axis])
        });
        let length = axes
            .chain([Some(self.channels)])
            .try_fold(1_usize, |all, axis| all.checked_mul(axis?))?;
        (length <= isize::MAX as usize / size_of::<f32>()).then_some(length)
    }

    /// Returns the start of the first pixel inside the border.
    pub(crate) fn origin(&self) -> usize {
        self.strides().iter().zip(&self.before).map(|(stride, before)| stride * before).sum()
    }

    /// Returns the number of pixels of all frames, without the border.
    pub(crate) fn pixels(&self) -> usize {
        self.size.iter().product()
    }

    /// Returns true if there is a border.
    pub(crate) fn has_border(&self) -> bool {
        self.before != [0; 3] || self.after != [0; 3]
    }

    /// Returns true if the border is at least this large.
    pub(crate) fn has_border_of(&self, before: Extent, after: Extent) -> bool {
        (0..3).all(|axis| self.before[axis] >= before[axis] && self.after[axis] >= after[axis])
    }

    /// Sets the border to zero.
    pub(crate) fn clear_border(&self, memory: &mut [f32]) {
        let strides = self.strides();
        // The memory before and after the inner part, from the whole down to one row.
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

    /// Enlarges the border to at least this size.
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
    /// The layout of the activation.
    pub(crate) layout: Layout,
    /// First channel.
    pub(crate) first: usize,
    /// Number of channels.
    pub(crate) count: usize,
}

impl Channels {
    /// Returns the start of the channels of the first pixel inside the border.
    pub(crate) fn origin(&self) -> usize {
        self.layout.origin() + self.first
    }

    /// Returns true if the activation has these channels.
    pub(crate) fn exist(&self) -> bool {
        let end = self.first.checked_add(self.count);
        self.count > 0 && end.is_some_and(|end| end <= self.layout.channels)
    }
}

/// Returns the position of the `index`-th pixel of an extent, columns running fastest.
pub(crate) fn position(index: usize, extent: Extent) -> Extent {
    let [_, rows, columns] = extent;
    [index / (rows * columns), index / columns % rows, index % columns]
}

/// Returns the dot product of a position and strides.
pub(crate) fn offset(position: Extent, strides: Extent) -> usize {
    position.iter().zip(&strides).map(|(at, stride)| at * stride).sum()
}
