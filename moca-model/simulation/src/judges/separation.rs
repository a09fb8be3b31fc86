//! Whether the robot keeps its distance from people, by formulas of its own and apart from the
//! controller.

pub(crate) mod body;
mod judgement;
mod monitor;
mod rod;

pub use judgement::{Blame, Verdict};
pub use monitor::{Moment, SeparationMonitor};
