//! What many tests need and none changes.

use std::sync::LazyLock;

use moca_model::RobotModel;

/// MOCA, read once.
pub(crate) static MOCA: LazyLock<RobotModel> = LazyLock::new(|| RobotModel::moca().unwrap());
