//! Closed-loop inverse kinematics: rotations, task rows, damping.

pub(crate) mod clik;
pub(crate) mod damping;
pub(crate) mod rotation;
