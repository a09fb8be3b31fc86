//! Command-line options that the programs with networks share.

pub mod action_options;
pub mod choices;
pub mod live;
