//! Weights in the order in which the kernels read them.

use super::buffer::Buffer;
use super::isa::InstructionSet;

/// How the output channels of a layer are cut into panels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Panels {
    /// Parts of the layer that see channels of their own.
    pub(crate) groups: usize,
    /// Output channels of a group.
    pub(crate) channels: usize,
    /// Channels of a panel, the last one of a group filled up with zeros.
    pub(crate) width: usize,
}

impl Panels {
    /// The widest panels that this instruction set uses and that waste no more than 16 channels; narrow ones for few.
    pub(crate) fn new(isa: InstructionSet, channels: usize) -> Self {
        Self::of_groups(isa, 1, channels)
    }

    /// The same for groups of so many channels.
    pub(crate) fn of_groups(isa: InstructionSet, groups: usize, channels: usize) -> Self {
        let mut width = isa.panel_width();
        while width > 16 && channels.next_multiple_of(width) >= channels.next_multiple_of(16) + 16 {
            width /= 2;
        }
        if channels <= isa.narrowest_panel() {
            width = isa.narrowest_panel();
        }
        Self { groups, channels, width }
    }

    /// Output channels of the layer.
    pub(crate) fn outputs(&self) -> usize {
        self.groups * self.channels
    }

    /// How many panels there are.
    pub(crate) fn count(&self) -> usize {
        self.groups * self.of_group()
    }

    /// How many panels a group has.
    fn of_group(&self) -> usize {
        self.channels.div_ceil(self.width)
    }

    /// The group of a panel.
    pub(crate) fn group(&self, panel: usize) -> usize {
        panel / self.of_group()
    }

    /// The first channel of a panel.
    pub(crate) fn first(&self, panel: usize) -> usize {
        self.group(panel) * self.channels + panel % self.of_group() * self.width
    }

    /// Channels with those that fill up the last panel.
    pub(crate) fn padded(&self) -> usize {
        self.count() * self.width
    }

    /// How many channels of this panel exist.
    pub(crate) fn channels_of(&self, panel: usize) -> usize {
        self.width.min(self.channels.saturating_sub(panel % self.of_group() * self.width))
    }

    /// A value for each channel of the panels from one for each channel of the layer; zero where panels are
    /// filled up.
    pub(crate) fn spread(&self, values: &[f32]) -> Vec<f32> {
        let mut spread = vec![0.0; self.padded()];
        for (panel, target) in spread.chunks_exact_mut(self.width).enumerate() {
            let (first, channels) = (self.first(panel), self.channels_of(panel));
            target[..channels].copy_from_slice(&values[first..first + channels]);
        }
        spread
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
            column(panels.first(index) + lane, &mut values);
            for (row, &value) in panel.chunks_exact_mut(panels.width).zip(&values) {
                row[lane] = value;
            }
        }
    }
    packed
}
