#![doc = include_str!("../README.md")]

mod error;
pub mod maps;
pub mod sheets;
pub mod workload;

pub use error::Error;
