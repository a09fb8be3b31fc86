//! Networks over files: images, folders of images, and clips.

mod array;
mod checkpoint;
pub mod classifier;
mod clip_classifier;
pub mod clip_stream;
pub mod clips;
mod decider;
pub mod folders;
mod input;
pub mod names;
pub mod tensor_name;
pub mod top_k;

pub use array::ArrayNetwork;
pub use checkpoint::{open_checkpoint, open_weights};
pub use clip_classifier::{ClipClassifier, ClipScores};
pub use decider::Decider;
pub use input::Input;
