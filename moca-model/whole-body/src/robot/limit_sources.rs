//! Mimic joints whose limits are in force.

/// The mimic joints whose limits are in force for an entry of q̇, by their indices.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct LimitSources {
    pub(super) position: [Option<usize>; 2],
    pub(super) velocity: Option<usize>,
    pub(super) acceleration: Option<usize>,
    pub(super) jerk: Option<usize>,
}
