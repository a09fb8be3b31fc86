//! The command that an arm on the ROS 2 graph follows.

use moca_drivers::ros2::JointInterface;

/// The commands that the joints of the arm follow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum FollowedBy {
    /// Torques.
    #[default]
    Effort,
    /// Velocities.
    Velocity,
    /// Positions.
    Position,
}

impl From<FollowedBy> for JointInterface {
    fn from(kind: FollowedBy) -> Self {
        match kind {
            FollowedBy::Effort => Self::Effort,
            FollowedBy::Velocity => Self::Velocity,
            FollowedBy::Position => Self::Position,
        }
    }
}
