//! Velocities that do what the tasks ask, in their order and within the limits.

pub(crate) mod commanded;
pub(crate) mod differential;
pub(crate) mod leash;
pub(crate) mod settings;
mod singularity;
