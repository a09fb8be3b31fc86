//! Capsules in settings files.

use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Capsule;
use crate::error::Error;

/// A capsule as a table.
#[derive(Clone, Copy, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct CapsuleTable {
    /// Start of its segment \[m\].
    start: [f64; 3],
    /// End of its segment \[m\].
    end: [f64; 3],
    /// Radius of the capsule \[m\].
    radius: f64,
}

impl From<Capsule> for CapsuleTable {
    fn from(capsule: Capsule) -> Self {
        let (start, end) = (*capsule.start(), *capsule.end());
        Self { start: start.into(), end: end.into(), radius: capsule.radius() }
    }
}

impl TryFrom<CapsuleTable> for Capsule {
    type Error = Error;

    fn try_from(table: CapsuleTable) -> Result<Self, Error> {
        Self::new(Vector3::from(table.start), Vector3::from(table.end), table.radius)
    }
}
