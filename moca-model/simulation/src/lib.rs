#![doc = include_str!("../README.md")]

mod error;
pub mod experiment;
pub mod judges;
pub mod plant;
mod quantile;
pub mod rendering;
pub mod run;
pub mod soak;
pub mod workcell;

pub use error::Error;
/// Simulated people and the camera that sees them.
pub use simulated_people as people;
// Crates of the types in the public interface.
pub use {ergo_map, hrsw, hrsw_safety, moca_model, vision_models};
