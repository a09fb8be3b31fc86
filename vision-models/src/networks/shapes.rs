//! The size of every activation, and how each convolution is computed.

use crate::Error;
use crate::kernels::{Tiling, Window};
use crate::layout::{Extent, Layout};

use super::graph::{Graph, Layer, Step, Value};

/// How a convolution is computed. Its weights are packed for this at load.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Algorithm {
    Direct,
    Winograd(Tiling),
}

impl Algorithm {
    /// What measured fastest for a layer with an output of this size.
    pub(crate) fn choose(layer: &Layer, output: Extent) -> Self {
        let Window { kernel, stride, padding } = layer.window;
        let [frames, rows, columns] = output;
        let same = stride == [1; 3] && padding == kernel.map(|taps| taps / 2);
        if !same || !layer.inputs.is_multiple_of(16) || !layer.outputs.is_multiple_of(16) {
            return Self::Direct;
        }
        match kernel {
            // On the smallest images there are too few tiles to pay for the larger weights.
            [1, 3, 3] if rows * columns <= 49 && frames == 1 => Self::Direct,
            [1, 3, 3] if frames * rows * columns <= 196 => Self::Winograd(Tiling::Two),
            [1, 3, 3] => Self::Winograd(Tiling::Four),
            [3, 1, 1] if frames > 2 => Self::Winograd(Tiling::FourFrames),
            _ => Self::Direct,
        }
    }
}

/// The size of every value that the steps read or write, for the sizes of their inputs.
///
/// # Errors
/// [`Error::InputTooSmall`] if a kernel does not fit, [`Error::Layer`] for a step that reads what is
/// not there or writes where there is no room.
pub(crate) fn sizes(
    graph: &Graph,
    steps: &[Step],
    inputs: &[(Value, Extent)],
) -> Result<Vec<Option<Extent>>, Error> {
    let mut sizes = vec![None; graph.channels.len()];
    let mut given = Extent::default();
    for &(value, size) in inputs {
        sizes[value.0] = Some(size);
        given = size;
    }
    for step in steps {
        let refuse =
            |problem: String| Err(Error::Layer { layer: step.name(&graph.layers), problem });
        let (Value(input), Value(output)) = (step.input(), step.output());
        let Some(size) = sizes[input] else {
            return refuse("nothing has written its input".into());
        };
        if input == output {
            return refuse("it would overwrite its input".into());
        }
        for (needed, value) in step.channels(graph).into_iter().zip([input, output]) {
            let channels = graph.channels[value];
            if needed > channels {
                return refuse(format!(
                    "it takes {needed} channels of an activation of {channels}"
                ));
            }
        }
        let made = step.window(&graph.layers).output(size);
        let Some(made) = made.filter(|made| !made.contains(&0)) else {
            return Err(Error::InputTooSmall { size: given });
        };
        match sizes[output] {
            Some(there) if there != made => {
                return refuse(format!("its output of size {made:?} joins one of size {there:?}"));
            }
            None if step.adds() => return refuse("nothing is there that it could add to".into()),
            _ => sizes[output] = Some(made),
        }
    }
    Ok(sizes)
}

/// The layout of every value: its size, and the border that those who read it need.
pub(crate) fn layouts(
    graph: &Graph,
    steps: &[Step],
    sizes: &[Option<Extent>],
    algorithms: &[Algorithm],
) -> Vec<Option<Layout>> {
    let mut layouts: Vec<Option<Layout>> = sizes
        .iter()
        .zip(&graph.channels)
        .map(|(size, &channels)| size.map(|size| Layout::dense(size, channels)))
        .collect();
    for step in steps {
        // A pooling looks where the edges are.
        let Step::Convolution { layer, input, .. } = *step else { continue };
        let padding = graph.layers[layer].window.padding;
        if let Some(layout) = &mut layouts[input.0] {
            let after = match algorithms[layer] {
                Algorithm::Winograd(tiling) => tiling.after(layout.size),
                Algorithm::Direct => padding,
            };
            layout.widen(padding, after);
        }
    }
    layouts
}
