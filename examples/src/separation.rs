//! Whether the robot keeps its distance from people, by formulas of its own and apart from the
//! controller; for `follow` and `soak`.

pub(crate) mod body;
pub mod judgement;
mod monitor;
mod rod;

pub use monitor::{Moment, SeparationMonitor};
