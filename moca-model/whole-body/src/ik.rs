//! Differential inverse kinematics with strict priorities within limits.

pub(crate) mod commanded;
pub(crate) mod differential;
pub(crate) mod following_error;
pub(crate) mod settings;
mod singularity;

pub use commanded::{Command, Commanded};
pub use differential::{ActiveLimit, ActiveRow, IkBuilder, LevelReport, Step};
pub use following_error::FollowingErrorLimit;
pub use settings::IkSettings;
