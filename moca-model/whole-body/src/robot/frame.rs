//! Frames: the links, and the frames that a user adds.

use crate::spatial::Pose;

/// A frame of one [`Model`](crate::Model); see [`Model::frame_id`](crate::Model::frame_id).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct FrameId {
    pub(crate) model: u64,
    pub(crate) index: usize,
}

/// A link or an added frame, with its place on the body that carries it.
#[derive(Debug, Clone)]
pub(crate) struct Frame {
    pub(crate) name: String,
    pub(crate) body: usize,
    /// Pose in the body's frame.
    pub(crate) pose: Pose,
}
