//! The recording in the repository.

use percept_recording::{Reader, RecordingError};

/// The recording in the repository, as the `record` command makes it by default.
const SHIPPED: &[u8] = include_bytes!("../recordings/follow.jsonl");

/// The text of the recording in the repository.
pub fn bytes() -> &'static [u8] {
    SHIPPED
}

/// The recording in the repository: a person delivers an object, drills it while leading the robot around, and leaves.
///
/// # Errors
/// As [`Reader::new`]; the tests read it to the end.
pub fn recording() -> Result<Reader<&'static [u8]>, RecordingError> {
    Reader::new(SHIPPED)
}
