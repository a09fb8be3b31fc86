//! What the programs of this package are made of.

pub mod actions;
pub mod ergonomics;
mod excerpt;
pub mod experiment;
pub mod ik;
pub mod infer;
pub mod learning;
pub mod posture;
pub mod program;
pub mod settings;
pub mod shards;
pub mod sheets;
pub mod shipped;
pub mod soak;
pub mod surface;
pub mod vision;
pub mod workload;
