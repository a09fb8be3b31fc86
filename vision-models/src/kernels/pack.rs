//! Weights in the order in which the kernels read them.

use super::buffer::Buffer;
use super::isa::InstructionSet;

/// How the output channels of a layer are cut into panels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Panels {
    /// Output channels of the layer.
    pub(crate) channels: usize,
    /// Channels of a panel, the last one filled up with zeros.
    pub(crate) width: usize,
}

impl Panels {
    /// The widest panels that this instruction set uses and that waste no more than 16 channels.
    pub(crate) fn new(isa: InstructionSet, channels: usize) -> Self {
        let mut width = isa.panel_width();
        while width > 16 && channels.next_multiple_of(width) >= channels.next_multiple_of(16) + 16 {
            width /= 2;
        }
        Self { channels, width }
    }

    /// How many panels there are.
    pub(crate) fn count(&self) -> usize {
        self.channels.div_ceil(self.width)
    }

    /// Channels with those that fill up the last panel.
    pub(crate) fn padded(&self) -> usize {
        self.count() * self.width
    }

    /// How many channels of this panel exist.
    pub(crate) fn channels_of(&self, panel: usize) -> usize {
        self.width.min(self.channels.saturating_sub(panel * self.width))
    }
}

/// Packs a matrix into panels of [depth][width]; `column(channel)` gives the depth-long column of
/// one output channel through its argument.
pub(crate) fn pack(
    panels: Panels,
    depth: usize,
    mut column: impl FnMut(usize, &mut [f32]),
) -> Buffer {
    let mut packed = Buffer::zeroed(panels.padded() * depth);
    let mut values = vec![0.0; depth];
    for (index, panel) in packed.chunks_exact_mut(depth * panels.width).enumerate() {
        for lane in 0..panels.channels_of(index) {
            column(index * panels.width + lane, &mut values);
            for (row, &value) in panel.chunks_exact_mut(panels.width).zip(&values) {
                row[lane] = value;
            }
        }
    }
    packed
}
