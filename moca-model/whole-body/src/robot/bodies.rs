//! The tree that the algorithms walk.

use crate::spatial::{Motion, Pose};

/// What moves body k + 1 against its parent, if this is mover k. Body 0 is the root: the world, or
/// the floating base.
///
/// Bodies stand in depth-first order, so that a parent comes before its children. The frame of a
/// body is turned so that the axis of its mover is z: a rotation then mixes two columns, whatever
/// axis the URDF gives.
#[derive(Debug, Clone)]
pub(crate) struct Mover {
    pub(crate) parent: usize,
    pub(crate) motion: Motion,
    /// Pose in the parent's frame where the mover is at zero.
    pub(crate) placement: Pose,
    /// Which entry of q moves it.
    pub(crate) position: usize,
    /// Which entry of q̇ moves it.
    pub(crate) velocity: usize,
    /// Its position is ratio · q + offset; 1 and 0 but for a mimic joint.
    pub(crate) ratio: f64,
    pub(crate) offset: f64,
}
