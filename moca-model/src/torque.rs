//! The control loop of a robot whose arm takes torques.

mod controller;
mod settings;

pub use controller::{Measured, TorqueController};
pub use settings::TorqueLoopSettings;
