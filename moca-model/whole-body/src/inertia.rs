//! Inertias of single bodies and of trees of bodies.

pub(crate) mod articulated;
pub(crate) mod body;
pub(crate) mod symmetric;
pub(crate) mod world;
