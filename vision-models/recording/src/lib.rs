#![doc = include_str!("../README.md")]

mod check;
mod error;
mod format;
mod lines;
#[cfg(feature = "mcap")]
pub mod mcap;
mod reader;
mod segments;
mod timing;
mod whole;
mod writer;

pub use error::RecordingError;
pub use format::{Frame, Header};
pub use reader::{Completeness, Reader, open};
pub use segments::MeasuredSegments;
pub use timing::{Stamp, Timing, arrivals};
pub use whole::{IfPartial, Recording};
pub use writer::Writer;
