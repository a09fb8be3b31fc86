//! Recordings of what perception reported, as JSON Lines: a header, one line a camera frame, and a
//! closing line, so that a recording that was cut off does not pass for a whole one.
//! The book's page "Recordings" describes the format.
//!
//! ```
//! use examples::recording::{Header, Reader, Writer};
//! use vision_models::Percept;
//!
//! let percept = Percept { time: 0.05, body: None, action: None, surface: None };
//! let mut writer = Writer::new(Vec::new(), &Header::default())?;
//! writer.write(&percept)?;
//! let bytes = writer.finish()?;
//!
//! let percepts: Vec<Percept> = Reader::new(bytes.as_slice())?.collect::<Result<_, _>>()?;
//! assert_eq!(percepts, [percept]);
//! # Ok::<(), examples::recording::RecordingError>(())
//! ```

mod check;
mod error;
mod format;
mod lines;
mod reader;
mod segments;
mod timing;
mod whole;
mod writer;

use std::{fs::File, io::BufReader, path::Path};

pub use error::RecordingError;
pub use format::{Frame, Header};
pub use reader::Reader;
pub use segments::MeasuredSegments;
pub use timing::{Stamp, Timing, arrivals};
pub use whole::{Completeness, IfPartial, Recording};
pub use writer::Writer;

/// The recording that the repository ships, as the `record` command makes it without options.
const SHIPPED: &[u8] = include_bytes!("../recordings/follow.jsonl");

/// Opens a recording and reads its header.
///
/// # Errors
/// [`RecordingError::Open`] if the file cannot be opened, otherwise as [`Reader::new`].
pub fn open(path: impl AsRef<Path>) -> Result<Reader<BufReader<File>>, RecordingError> {
    let path = path.as_ref();
    let file = File::open(path)
        .map_err(|source| RecordingError::Open { path: path.to_owned(), source })?;
    Reader::new(BufReader::new(file))
}

/// The text of the recording that the repository ships.
pub fn shipped_bytes() -> &'static [u8] {
    SHIPPED
}

/// The recording that the repository ships: a person delivers an object, drills it while leading
/// the robot about, and leaves.
///
/// # Errors
/// As [`Reader::new`]; the tests read it to the end.
pub fn shipped() -> Result<Reader<&'static [u8]>, RecordingError> {
    Reader::new(SHIPPED)
}
