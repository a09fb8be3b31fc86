//! What the program `infer` is made of: a network, and what it does with images, clips and arrays.

pub mod arrays;
pub mod clips;
pub mod images;
pub mod network;
mod results;

pub use results::Results;
