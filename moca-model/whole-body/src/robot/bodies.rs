//! The tree of bodies that the algorithms traverse.

use crate::spatial::{Motion, Pose};

/// The joint that moves body k + 1 relative to its parent, for mover k. Body 0 is the root: the world or the floating
/// base.
///
/// Bodies are in depth-first order, so that a parent comes before its children. The frame of a body is rotated so that
/// the axis of its mover is z. A joint rotation then mixes only two columns, whatever axis the URDF states.
#[derive(Debug, Clone)]
pub(crate) struct Mover {
    pub(crate) parent: usize,
    pub(crate) motion: Motion,
    /// Pose in the parent's frame with the mover at zero.
    pub(crate) placement: Pose,
    /// Entry of q that moves it.
    pub(crate) position: usize,
    /// Entry of q̇ that moves it.
    pub(crate) velocity: usize,
    /// The position is ratio · q + offset, with 1 and 0 except for mimic joints.
    pub(crate) ratio: f64,
    pub(crate) offset: f64,
}
