//! Recordings and runs in MCAP, which Foxglove shows without a plugin.
//!
//! A recording keeps its lines as they are: those of frames are messages of `/percepts`, header and closing line
//! are metadata, so that [`to_json_lines`] gives back every byte that [`from_json_lines`] was given. Beside them
//! stand messages for the eye alone.

mod error;
mod from_json_lines;
mod messages;
mod records;
mod robot_log;
mod sink;
mod to_json_lines;

pub use error::McapFileError;
pub use from_json_lines::from_json_lines;
pub use robot_log::RobotLog;
pub use to_json_lines::to_json_lines;

/// Of the messages that are the recording.
const PERCEPTS: &str = "/percepts";
/// Their schema, and the name of the metadata.
const PERCEPT: &str = "moca.Percept";
const RECORDING: &str = "moca.Recording";
