//! What is wrong with the images or clips that a network is given.

use crate::error::Error;
use crate::layout::Extent;

/// Images or clips of the wrong shape.
pub(crate) fn wrong_input(shape: &[usize]) -> Error {
    let unit = "values (N, channels, frames, height, width)";
    let wanted =
        "at least one image or clip, of as many channels as the network takes, three as a rule";
    Error::size("an input", shape, unit, wanted)
}

/// Images or clips that are smaller than the network's kernels.
pub(crate) fn too_small(size: Extent) -> Error {
    Error::size("an input", &size, UNIT, "more: it is too small for the network's kernels")
}

/// Images or clips that are beyond all memory.
pub(crate) fn too_large(size: Extent) -> Error {
    Error::size("an input", &size, UNIT, "fewer: it is too large for the memory of this machine")
}

const UNIT: &str = "frames, rows and columns";

/// Activations that are too large for f32, so that there are no scores.
pub(super) fn overflow(input: usize) -> Error {
    Error::Overflow {
        what: format!("input {input}: an activation of the network"),
        cause: "normalise the input, and check that the weights are those of this network",
    }
}
