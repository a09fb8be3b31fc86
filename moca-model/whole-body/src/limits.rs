//! Hard limits: intervals of joint velocities, and rows that take precedence over all tasks.

pub(crate) mod anticipation;
pub(crate) mod common_point;
pub(crate) mod frame_velocity;
pub(crate) mod joint_intervals;
pub(crate) mod limit_kind;
pub(crate) mod wheels;

pub use ahqp_core::VelocityInterval;
pub use frame_velocity::FrameVelocityLimit;
pub use joint_intervals::{JointIntervals, nearest_to_rest};
pub use limit_kind::{End, LimitKind};
pub use wheels::WheelLimit;
