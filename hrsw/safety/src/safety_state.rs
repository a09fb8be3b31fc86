//! How much the robot may do.

/// How much the robot may do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum SafetyState {
    /// Full speed.
    #[default]
    Normal,
    /// Reduced speed.
    Reduced,
    /// Somebody is nearer than the protective distance: the robot comes no nearer, and leaves slowly.
    Retreat,
    /// At rest, still under control.
    ProtectiveStop,
}
