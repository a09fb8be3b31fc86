//! The recording that the repository ships.

use percept_recording::{Reader, RecordingError};

/// The recording that the repository ships, as the `record` command makes it without options.
const SHIPPED: &[u8] = include_bytes!("../recordings/follow.jsonl");

/// The text of the recording that the repository ships.
pub fn bytes() -> &'static [u8] {
    SHIPPED
}

/// The recording that the repository ships: a person delivers an object, drills it while leading
/// the robot about, and leaves.
///
/// # Errors
/// As [`Reader::new`]; the tests read it to the end.
pub fn recording() -> Result<Reader<&'static [u8]>, RecordingError> {
    Reader::new(SHIPPED)
}
