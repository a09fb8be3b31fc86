//! Robots to try a controller on: rigid bodies under torques, what touches them, what their sensors
//! say.

pub(crate) mod command_line;
pub(crate) mod contact;
pub(crate) mod rigid_body;
pub(crate) mod sensors;
pub(crate) mod transmission;
