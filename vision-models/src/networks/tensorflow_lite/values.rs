//! The tensors of the file while its graph is built.

use crate::engine::{Convolution, Value};
use crate::layout::Extent;

/// The size of an activation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Shape {
    pub(super) size: Extent,
    pub(super) channels: usize,
}

impl Shape {
    /// Returns the shape of a tensor with these axes. The first of four is one, and fewer are the
    /// last ones.
    pub(super) fn of(axes: &[usize]) -> Option<Self> {
        let mut all = [1; 4];
        all.get_mut(4_usize.checked_sub(axes.len())?..)?.copy_from_slice(axes);
        let [batch, rows, columns, channels] = all;
        (batch == 1 && !axes.contains(&0)).then_some(Self { size: [1, rows, columns], channels })
    }

    /// Returns frames, rows, columns and channels.
    pub(super) fn axes(&self) -> [usize; 4] {
        let [frames, rows, columns] = self.size;
        [frames, rows, columns, self.channels]
    }

    /// Returns channels, rows and columns.
    pub(super) fn image(&self) -> [usize; 3] {
        [self.channels, self.size[1], self.size[2]]
    }

    /// Returns the number of elements. Saturates beyond the size of memory.
    pub(super) fn elements(&self) -> usize {
        self.axes().into_iter().fold(1, usize::saturating_mul)
    }
}

/// An activation of the graph.
#[derive(Clone, Copy, Debug)]
pub(super) struct Known {
    pub(super) value: Value,
    pub(super) shape: Shape,
}

/// Zeros before and after an activation's rows, columns and channels.
pub(super) type Zeros = [[usize; 2]; 3];

/// A tensor that an operator has written.
#[derive(Clone, Debug)]
pub(super) enum Written {
    /// The elements of another tensor in the file.
    Constant(usize),
    /// An activation.
    Activation(Known),
    /// A convolution that is not in the graph yet. A following addition or function may become part
    /// of it.
    Convolution { layer: Convolution, input: Value, shape: Shape },
    /// An activation with zeros around it, which may become the padding of convolutions.
    Padded { input: usize, zeros: Zeros, shape: Shape },
}

impl Written {
    /// Returns the size of a computed tensor.
    pub(super) fn shape(&self) -> Option<Shape> {
        match self {
            Self::Constant(_) => None,
            Self::Activation(known) => Some(known.shape),
            Self::Convolution { shape, .. } | Self::Padded { shape, .. } => Some(*shape),
        }
    }
}
