//! Folders of camera frames: colour and depth images with the camera's geometry. The book's page "Recordings"
//! describes the layout.

pub(crate) mod format;
pub(crate) mod reader;
pub mod truth;
mod writer;

pub use format::FrameEntry;
pub use reader::FramesReader;
pub use writer::{ColourImage, FramesWriter};
