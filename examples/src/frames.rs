//! Folders of camera frames: colour and depth images with the camera's geometry, as `record --frames`
//! writes them and `perceive` reads them. The book's page "Recordings" describes the layout.

mod error;
mod format;
mod reader;
pub mod truth;
mod writer;

pub use error::FramesError;
pub use format::FrameEntry;
pub use reader::FramesReader;
pub use writer::FramesWriter;
