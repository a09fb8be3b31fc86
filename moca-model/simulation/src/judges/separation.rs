//! Judge of the robot's distance from people, independent of the controller.
//!
//! It shares with the controller the numbers of its settings ([`Terms`], [`Rods`], the control period) and the robot's
//! model: kinematics and limits of the joints. It does not share geometry and formulas: the capsules around people, the
//! distance of two capsules, speeds, the protective distance and the emergency stop are its own.

pub(crate) mod body;
mod judgement;
mod monitor;
mod rod;

pub use judgement::{Blame, Terms, Verdict};
pub use monitor::{Moment, Rods, SeparationMonitor};
pub use rod::Rod;
