//! Values that many tests need and none changes.

use std::sync::LazyLock;

use moca_model::moca;
use moca_model::whole_body::Model;

/// MOCA, read once.
pub(crate) static MOCA: LazyLock<Model> = LazyLock::new(|| moca().unwrap());
