//! Networks over files: images, folders of images, and clips.

mod checkpoint;
pub mod classifier;
pub mod clip_stream;
pub mod clips;
pub mod folders;
pub mod names;
pub mod tensor_name;
pub mod top_k;

pub use checkpoint::{open_checkpoint, open_weights};
