#![doc = include_str!("../README.md")]

pub mod actions;
mod error;
mod file;
pub mod film;
pub mod frames;
pub mod learning;
pub mod networks;
pub mod npy;
pub mod percepts;
mod random;
pub mod surface;
mod watch;

pub use error::Error;
pub use watch::{Event, Watch, wait_while};
