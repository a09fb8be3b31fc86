//! What is solved: rows, levels, hierarchies.

pub(crate) mod hierarchy;
pub(crate) mod rows;
