//! Judge of the robot's distance from people, with formulas of its own and independent of the controller.

pub(crate) mod body;
mod judgement;
mod monitor;
mod rod;

pub use judgement::{Blame, Verdict};
pub use monitor::{Moment, SeparationMonitor};
