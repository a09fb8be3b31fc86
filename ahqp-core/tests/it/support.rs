//! What several tests need.

use ahqp_core::{Hierarchy, LevelId};

/// The id of a level by its place.
pub(crate) fn id(hierarchy: &Hierarchy, index: usize) -> LevelId {
    hierarchy.ids().nth(index).unwrap()
}
