//! Recordings in MCAP, which Foxglove displays without a plugin.
//!
//! A recording keeps its lines unchanged. The lines of frames are messages of `/percepts`. Header
//! and closing line are metadata. [`to_json_lines`] therefore returns every byte that
//! [`from_json_lines`] was given. The file also has messages for display only. A [`McapWriter`]
//! adds further channels of [`Message`]s.
//!
//! ```
//! use percept_recording::mcap::{from_json_lines, to_json_lines};
//! use percept_recording::{Header, Writer};
//! use vision_models::Percept;
//!
//! let mut writer = Writer::new(Vec::new(), &Header::default())?;
//! writer.write(&Percept { time: 0.05, body: None, action: None, surface: None })?;
//! let recording = writer.finish()?;
//! assert_eq!(to_json_lines(&from_json_lines(&recording)?)?, recording);
//! # Ok::<(), percept_recording::mcap::McapError>(())
//! ```

mod error;
mod from_json_lines;
mod messages;
mod records;
mod to_json_lines;
mod writer;

pub use error::McapError;
pub use from_json_lines::from_json_lines;
pub use messages::{Colour, Deletion, Entity, Message, Rotation, SceneUpdate, Shape, Time, Xyz};
pub use to_json_lines::to_json_lines;
pub use writer::{Channel, McapWriter};

/// Topic of the messages of the recording.
const PERCEPTS: &str = "/percepts";
/// Their schema, and the name of the metadata.
const PERCEPT: &str = "moca.Percept";
const RECORDING: &str = "moca.Recording";
