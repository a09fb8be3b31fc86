//! Errors of a network's input images or clips.

use crate::error::Error;
use crate::layout::Extent;

/// Returns the error for images or clips of the wrong shape.
pub(crate) fn wrong_input(shape: &[usize]) -> Error {
    let unit = "values (N, channels, frames, height, width)";
    let wanted =
        "at least one image or clip, of as many channels as the network takes, three as a rule";
    Error::size("an input", shape, unit, wanted)
}

/// Returns the error for images or clips that are smaller than the network's kernels.
pub(crate) fn too_small(size: Extent) -> Error {
    Error::size("an input", &size, UNIT, "more: it is too small for the network's kernels")
}

/// Returns the error for images or clips that are too large for any memory.
pub(crate) fn too_large(size: Extent) -> Error {
    Error::size("an input", &size, UNIT, "fewer: it is too large for the memory of this machine")
}

const UNIT: &str = "frames, rows and columns";

/// Returns the error for activations that are too large for f32, so that there are no scores.
pub(super) fn overflow(input: usize) -> Error {
    Error::Overflow {
        what: format!("input {input}: an activation of the network"),
        cause: "normalise the input, and check that the weights are those of this network",
    }
}
