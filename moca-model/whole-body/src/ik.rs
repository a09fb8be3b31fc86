//! Differential inverse kinematics with strict priorities within limits.

pub(crate) mod commanded;
pub(crate) mod differential;
pub(crate) mod leash;
pub(crate) mod settings;
mod singularity;

pub use commanded::{Command, Commanded};
pub use differential::{ActiveLimit, ActiveRow, IkBuilder, LevelReport, Step};
pub use leash::Leash;
pub use settings::IkSettings;
