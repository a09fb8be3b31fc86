//! The program `experiment`: options, shards, tables, figures and pages of the paper's experiments.

mod commands;
mod options;
mod play;
mod recordings;

pub use commands::{Following, Reorientation, Subjects};
pub use options::make_folder;
pub use play::{merge, program};
