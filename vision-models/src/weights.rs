//! Checkpoints: their contents and their readers.

mod budget;
mod checkpoint;
mod contents;
mod element;
mod error;
mod input;
mod pickle;
mod safetensors;
mod shape;
mod source;
mod state_dict;
mod tensor_info;
pub(crate) mod tensorflow_lite;
mod tensors;
mod torch;
mod zip;

pub(crate) use budget::Budget;
pub use checkpoint::Checkpoint;
pub use contents::Format;
pub use element::ElementType;
pub(crate) use error::refused;
pub use source::TensorSource;
pub(crate) use source::no_tensor;
pub use tensor_info::TensorInfo;
pub(crate) use tensors::unfilled;
pub use tensors::{Tensor, Tensors};
