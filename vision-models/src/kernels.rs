//! The numerical kernels, and all `unsafe` code of this crate.
//!
//! A kernel is written once over [`vector::Vector`] and compiled for each instruction set. The set
//! is chosen when the program starts. The interface to the rest of the crate is safe: slices,
//! layouts and plans are checked against each other before pointers are made.
#![allow(unsafe_code)]
// A function that is generic over the instruction set has it enabled only where it is inlined.
#![allow(clippy::inline_always)]

mod affinity;
mod buffer;
mod copy;
mod depthwise;
mod direct;
mod epilogue;
mod isa;
mod pack;
mod pooling;
mod product;
mod resize;
mod shared_slice;
#[cfg(test)]
mod tests;
mod threads;
mod vector;
mod window;
mod winograd;

pub(crate) use buffer::Buffer;
pub(crate) use copy::Copy;
pub(crate) use depthwise::Depthwise;
pub(crate) use direct::{Direct, Operands};
pub(crate) use epilogue::{Epilogue, Finish};
pub use isa::InstructionSet;
pub(crate) use pack::{Panels, pack};
pub(crate) use pooling::MaxPool;
pub use resize::Alignment;
pub(crate) use resize::Resize;
pub(crate) use threads::Pool;
pub use threads::Waiting;
pub(crate) use window::Phase;
pub use window::Window;
pub(crate) use winograd::{Tiling, Winograd};
