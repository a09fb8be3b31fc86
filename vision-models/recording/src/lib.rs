#![doc = include_str!("../README.md")]

mod check;
mod error;
mod excerpt;
mod format;
mod lines;
#[cfg(feature = "mcap")]
pub mod mcap;
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
