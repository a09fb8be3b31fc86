//! Closed-loop inverse kinematics: rotations and task rows.

pub(crate) mod clik;
pub(crate) mod rotation;
