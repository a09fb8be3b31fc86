//! What the programs `follow` and `record` are made of.

pub mod ergonomics;
pub mod follow;
pub mod hqp_file;
mod random;
pub mod recording;
pub mod report;
pub mod score_rows;
pub mod soak;
pub mod walker;
