//! Folders of camera frames: colour and depth images with the camera's geometry. The book's page "Recordings"
//! describes the layout.

pub(crate) mod format;
mod images;
mod placing;
pub(crate) mod reader;
pub mod truth;
mod writer;

pub use format::FrameEntry;
pub use images::{FrameImages, Picture};
pub use placing::CameraToPlace;
pub use reader::{FramesReader, PlacedCamera};
pub use writer::{ColourImage, FramesWriter};
