//! Torque control of a robot that works with a person.

mod controller;
mod payload_watch;
mod settings;
pub(crate) mod start;

pub use controller::TorqueController;
pub use settings::{AnswerDelay, TorqueLoopSettings};

/// Longest delay at which springs and dampers do not oscillate \[s\], and the longest time between measurements.
pub(crate) const LONGEST_DELAY: f64 = 4.5e-3;
pub(crate) const LONGEST_INTERVAL: f64 = 4e-3;
