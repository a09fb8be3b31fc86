//! Posture scores of a person on film, on the command line.

mod options;
mod run;

pub use options::FilmOptions;
pub use run::{FilmReport, Outputs, score};
