//! Networks on files: images, folders of images, and clips.

mod array;
pub(crate) mod checkpoint;
pub mod classifier;
mod clip_classifier;
pub mod clip_stream;
pub(crate) mod clips;
pub(crate) mod decider;
pub mod folders;
mod input;
pub mod names;
pub mod top_k;

pub use array::ArrayNetwork;
pub use checkpoint::{open_checkpoint, open_weights};
pub use clip_classifier::{ClipClassifier, ClipScores};
pub use decider::Decider;
pub use input::Input;
