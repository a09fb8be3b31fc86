//! Command-line options that the programs with networks share.

pub mod action_options;
pub mod choices;
pub mod live;
pub mod report;
#[cfg(feature = "ros2")]
pub mod ros2;
pub mod source;
