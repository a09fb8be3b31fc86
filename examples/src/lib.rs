//! What the programs of this package are made of.

pub mod actions;
pub mod ergonomics;
mod excerpt;
pub mod experiment;
pub mod follow;
pub mod frames;
pub mod hqp_file;
pub mod hqp_solving;
pub mod ik;
pub mod learning;
pub mod limits;
#[cfg(feature = "mcap")]
pub mod mcap_files;
pub mod page;
pub mod perception;
pub mod picture;
pub mod plant;
pub mod program;
mod random;
pub mod recording;
pub mod rendering;
pub mod replay;
pub mod report;
pub mod robot_side;
pub mod separation;
pub mod settings;
pub mod shards;
pub mod sheets;
pub mod simulation;
pub mod soak;
pub mod surface;
pub mod vision;
pub mod workload;
