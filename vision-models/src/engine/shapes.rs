//! The size of every activation, and the algorithm of each convolution.

use crate::error::Error;
use crate::kernels::{Tiling, Window};
use crate::layout::{Channels, Extent, Layout};

use super::input::{too_large, too_small};
use super::layer::Convolution;
use super::program::{Layer, Program, Slot, Step};

/// Longest axis of an activation: longer than any image, and short enough for products with
/// windows.
const MAX_AXIS: usize = 1 << 24;

/// The algorithm of a convolution. The weights are packed for it at loading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Algorithm {
    Direct,
    Depthwise,
    Winograd(Tiling),
}

impl Algorithm {
    /// Chooses the algorithm that was measured to be fastest for a layer with an output of this
    /// size.
    pub(crate) fn choose(layer: &Layer, output: Extent) -> Self {
        let Convolution { window, outputs, groups, transposed, .. } = layer.convolution;
        let Window { kernel, stride, padding, dilation, extra } = window;
        if !transposed && groups > 1 && groups == outputs && groups == layer.inputs {
            return Self::Depthwise;
        }
        let [frames, rows, columns] = output;
        let plain = !transposed && groups == 1 && dilation == [1; 3];
        let same = stride == [1; 3] && padding == kernel.map(|taps| taps / 2) && extra == [0; 3];
        let whole = layer.inputs.is_multiple_of(16) && outputs.is_multiple_of(16);
        if !plain || !same || !whole {
            return Self::Direct;
        }
        match kernel {
            // The smallest images have too few tiles for the larger weights.
            [1, 3, 3] if rows * columns <= 49 && frames == 1 => Self::Direct,
            [1, 3, 3] if frames * rows * columns <= 196 => Self::Winograd(Tiling::Two),
            [1, 3, 3] => Self::Winograd(Tiling::Four),
            [3, 1, 1] if frames > 2 => Self::Winograd(Tiling::FourFrames),
            _ => Self::Direct,
        }
    }
}

/// Returns the size of every activation that the steps read or write, for the sizes of their
/// inputs.
///
/// # Errors
/// - [`Error::Size`] if a kernel does not fit or an activation is too large for any memory.
/// - [`Error::Layer`] if a step reads a missing activation, or joins activations of different
///   sizes.
pub(crate) fn sizes(
    program: &Program,
    steps: &[Step],
    inputs: &[(Slot, Extent)],
) -> Result<Vec<Option<Extent>>, Error> {
    let mut sizes = vec![None; program.channels.len()];
    let mut given = Extent::default();
    for &(slot, size) in inputs {
        sizes[slot.activation] = Some(size);
        given = size;
        check_size(size, given)?;
    }
    for step in steps {
        let refuse =
            |problem: String| Err(Error::Layer { layer: step.name(&program.layers), problem });
        let (input, output) = (step.input().activation, step.output().activation);
        let Some(size) = sizes[input] else {
            return refuse("nothing has written its input".into());
        };
        let made = step.size(&program.layers, size).ok_or_else(|| too_small(given))?;
        check_size(made, given)?;
        if let Step::Reshape { input, output, .. } = *step {
            let elements = |size: Extent, count: usize| {
                size.into_iter().chain([count]).try_fold(1_usize, usize::checked_mul)
            };
            let (read, written) = (elements(size, input.count), elements(made, output.count));
            if read.is_none() || read != written {
                let [from, to] = [(size, input.count), (made, output.count)];
                return refuse(format!("it makes {to:?} of {from:?} (size, channels)"));
            }
        }
        match sizes[output] {
            Some(there) if there != made => {
                return refuse(format!("its output of size {made:?} joins one of size {there:?}"));
            }
            _ => sizes[output] = Some(made),
        }
    }
    Ok(sizes)
}

fn check_size(size: Extent, given: Extent) -> Result<(), Error> {
    if size.contains(&0) {
        return Err(too_small(given));
    }
    if size.into_iter().any(|axis| axis > MAX_AXIS) {
        return Err(too_large(given));
    }
    Ok(())
}

/// Returns the layout of every activation: its size, and the border that the steps that read it
/// need.
pub(crate) fn layouts(
    program: &Program,
    steps: &[Step],
    sizes: &[Option<Extent>],
    algorithms: &[Algorithm],
) -> Vec<Option<Layout>> {
    let mut layouts: Vec<Option<Layout>> = sizes
        .iter()
        .zip(&program.channels)
        .map(|(size, &channels)| size.map(|size| Layout::dense(size, channels)))
        .collect();
    for step in steps {
        // A pooling handles the edges itself.
        let Step::Convolution { layer, input, output, .. } = *step else { continue };
        let Convolution { window, transposed, .. } = program.layers[layer].convolution;
        let Some(made) = sizes[output.activation] else { continue };
        if let Some(layout) = &mut layouts[input.activation] {
            if let Algorithm::Winograd(tiling) = algorithms[layer] {
                layout.widen(window.padding, tiling.after(layout.size));
                continue;
            }
            let phases = if transposed { window.phases(made) } else { vec![window.whole(made)] };
            for phase in phases {
                let [before, after] = phase.border(layout.size);
                layout.widen(before, after);
            }
        }
    }
    layouts
}

/// Returns the channels of a slot in their layout.
pub(crate) fn channels(slot: Slot, layout: Layout) -> Channels {
    Channels { layout, first: slot.first, count: slot.count }
}
