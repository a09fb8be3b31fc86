//! Command-line options that the programs with networks share.

pub mod choices;
