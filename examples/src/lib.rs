//! Parts of the programs of this package.

pub mod actions;
pub mod drive;
pub mod experiment;
pub mod film;
pub mod infer;
pub mod learning;
pub mod maps;
pub mod posture;
pub mod program;
pub mod settings;
pub mod shards;
pub mod shipped;
pub mod soak;
pub mod stacking;
pub mod surface;
pub mod vision;
