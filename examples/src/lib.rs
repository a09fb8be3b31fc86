//! What the programs `follow` and `record` are made of.

pub mod follow;
pub mod recording;
pub mod report;
pub mod walker;
