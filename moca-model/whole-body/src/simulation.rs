//! Simulated robots for testing controllers: rigid bodies under torques, contacts and sensors.

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
