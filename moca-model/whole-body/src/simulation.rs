//! Robots to try a controller on: rigid bodies under torques, what touches them, what their sensors
//! say.

pub(crate) mod command_line;
pub(crate) mod contact;
pub(crate) mod rigid_body;
pub(crate) mod sensors;
pub(crate) mod transmission;

pub use command_line::CommandLine;
pub use contact::Contact;
pub use rigid_body::{JointDrive, RigidBodySimulation};
pub use sensors::{RandomSource, SensorSettings, Sensors};
pub use transmission::Transmission;
