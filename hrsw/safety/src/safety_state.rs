//! Safety states of the robot.

/// Safety state: how much the robot may do, from least to most strict.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum SafetyState {
    /// Full speed.
    #[default]
    Normal,
    /// Reduced speed.
    Reduced,
    /// A person is inside the protective distance. The robot does not approach, and leaves slowly.
    Retreat,
    /// Standstill, still under control.
    ProtectiveStop,
}
