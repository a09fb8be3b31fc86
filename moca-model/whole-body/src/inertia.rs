//! Inertias, from that of one body to those of bodies that joints join.

pub(crate) mod articulated;
pub(crate) mod body;
pub(crate) mod symmetric;
pub(crate) mod world;
