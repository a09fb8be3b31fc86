//! Problems: rows, levels and hierarchies.

pub(crate) mod hierarchy;
pub(crate) mod ids;
pub(crate) mod level;
pub(crate) mod matrix;
pub(crate) mod rows;
pub(crate) mod source;
