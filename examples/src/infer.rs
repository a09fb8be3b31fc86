//! Parts of the program `infer`: a network, and its use for images, clips and arrays.

pub mod arrays;
pub mod clips;
pub mod images;
pub mod network;
mod results;

pub use results::Results;
