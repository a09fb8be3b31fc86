//! What the programs of this package are made of.

pub mod actions;
mod excerpt;
pub mod experiment;
pub mod follow;
pub mod frames;
pub mod learning;
pub mod maps;
#[cfg(feature = "mcap")]
pub mod mcap_files;
pub mod perception;
pub mod program;
pub mod rendering;
pub mod separation;
pub mod settings;
pub mod shards;
pub mod shipped;
pub mod soak;
pub mod surface;
pub mod vision;
