//! From velocities to torques, and from torques and motion to what pushes the robot.

pub(crate) mod contact_force;
pub(crate) mod control;
pub(crate) mod delay_probe;
pub(crate) mod impedance;
pub(crate) mod measurement_watch;
pub(crate) mod momentum_observer;
pub(crate) mod prediction;
pub(crate) mod resynchronisation;
pub(crate) mod support;
