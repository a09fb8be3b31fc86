//! The robot: MOCA's model and figures, and the kinematics that a tick needs of any robot.

pub(crate) mod bodies;
mod inertia;
pub(crate) mod kinematics;
pub(crate) mod moca;
pub(crate) mod moca_safety;
