//! Differential inverse kinematics with strict priorities within limits.

pub(crate) mod differential;
pub(crate) mod settings;
mod singularity;

pub use differential::{ActiveLimit, ActiveRow, IkBuilder, LevelReport, Step};
pub use settings::IkSettings;
