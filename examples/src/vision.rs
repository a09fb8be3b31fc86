//! What the programs that run networks share on the command line.

pub mod choices;
