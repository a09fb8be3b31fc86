//! Recordings in MCAP, which Foxglove shows without a plugin.
//!
//! A recording keeps its lines as they are: those of frames are messages of `/percepts`, header and closing line
//! are metadata, so that [`to_json_lines`] gives back every byte that [`from_json_lines`] was given. Beside them
//! stand messages for the eye alone. A [`McapWriter`] takes further channels of [`Message`]s.
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

/// Of the messages that are the recording.
const PERCEPTS: &str = "/percepts";
/// Their schema, and the name of the metadata.
const PERCEPT: &str = "moca.Percept";
const RECORDING: &str = "moca.Recording";
