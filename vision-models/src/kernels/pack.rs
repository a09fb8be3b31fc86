//! Packs weights in the order in which the kernels read them.

use super::buffer::Buffer;
use super::isa::InstructionSet;

/// Channels of the narrowest panel: half a register of AVX-512, one of AVX2, two of NEON.
const NARROWEST: usize = 8;

/// The division of a layer's output channels into panels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Panels {
    /// Number of groups, each of which reads its own input channels.
    pub(crate) groups: usize,
    /// Number of output channels of a group.
    pub(crate) channels: usize,
    /// Channels of a panel. The last panel of a group is padded with zeros.
    pub(crate) width: usize,
}

impl Panels {
    /// Returns the panels that fill the output without padding, as wide as possible. Channels are a
    /// multiple of 16.
    pub(crate) fn whole(isa: InstructionSet, channels: usize) -> Self {
        let mut width = isa.panel_width();
        while width > 16 && !channels.is_multiple_of(width) {
            width /= 2;
        }
        Self { groups: 1, channels, width }
    }

    /// Returns the fastest panels for groups of this many channels.
    ///
    /// The time of a panel grows with its width, padding included. Additions of 16 channels are too
    /// few to hide their latency: they take as long as those of 21.
    pub(crate) fn of_groups(isa: InstructionSet, groups: usize, channels: usize) -> Self {
        let widths = [64, 32, 16].into_iter().filter(|&width| width <= isa.panel_width());
        let time = |width: usize| channels.div_ceil(width) * (3 * width / 16).max(4);
        let width = match channels {
            0..=NARROWEST => NARROWEST,
            _ => widths.min_by_key(|&width| time(width)).unwrap_or(16),
        };
        Self { groups, channels, width }
    }

    /// Returns the number of output channels of the layer.
    pub(crate) fn outputs(&self) -> usize {
        self.groups * self.channels
    }

    /// Returns the number of panels.
    pub(crate) fn count(&self) -> usize {
        self.groups * self.of_group()
    }

    /// Returns the number of panels of a group.
    fn of_group(&self) -> usize {
        self.channels.div_ceil(self.width)
    }

    /// Returns the group of a panel.
    pub(crate) fn group(&self, panel: usize) -> usize {
        panel / self.of_group()
    }

    /// Returns the first channel of a panel.
    pub(crate) fn first(&self, panel: usize) -> usize {
        self.group(panel) * self.channels + panel % self.of_group() * self.width
    }

    /// Returns the number of channels including the padding.
    pub(crate) fn padded(&self) -> usize {
        self.count() * self.width
    }

    /// Returns how many channels of this panel exist.
    pub(crate) fn channels_of(&self, panel: usize) -> usize {
        self.width.min(self.channels.saturating_sub(panel % self.of_group() * self.width))
    }

    /// Returns a value for each channel of the panels from one for each channel of the layer. The
    /// padding is zero.
    pub(crate) fn spread(&self, values: &[f32]) -> Vec<f32> {
        let mut spread = vec![0.0; self.padded()];
        for (panel, target) in spread.chunks_exact_mut(self.width).enumerate() {
            let (first, channels) = (self.first(panel), self.channels_of(panel));
            target[..channels].copy_from_slice(&values[first..first + channels]);
        }
        spread
    }
}

/// Columns that are packed at a time: half a cache line, so that few lines are written more than once.
const COLUMNS: usize = 8;

/// Packs a matrix into panels of [depth][width]. `column(channel)` writes the column of one output
/// channel, of length `depth`, into its argument.
pub(crate) fn pack(
    panels: Panels,
    depth: usize,
    mut column: impl FnMut(usize, &mut [f32]),
) -> Buffer {
    let mut packed = Buffer::zeroed(panels.padded() * depth);
    let mut values = vec![0.0; COLUMNS * depth];
    for (index, panel) in packed.chunks_exact_mut(depth * panels.width).enumerate() {
        let (first, channels) = (panels.first(index), panels.channels_of(index));
        for start in (0..channels).step_by(COLUMNS) {
            let lanes = start..channels.min(start + COLUMNS);
            for (lane, values) in lanes.clone().zip(values.chunks_exact_mut(depth)) {
                column(first + lane, values);
            }
            for (at, row) in panel.chunks_exact_mut(panels.width).enumerate() {
                let values = values.iter().skip(at).step_by(depth);
                for (value, &from) in row[lanes.clone()].iter_mut().zip(values) {
                    *value = from;
                }
            }
        }
    }
    packed
}
