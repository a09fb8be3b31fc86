//! MOCA's model and data, and the kinematics of any robot in a tick.

pub(crate) mod bodies;
mod inertia;
pub(crate) mod kinematics;
pub(crate) mod moca;
pub(crate) mod moca_safety;
pub(crate) mod self_collision;
mod stopping;
