//! Reads a recording to its end, with a choice for partial ones.

use std::io::BufRead;

use vision_models::{Body, Percept};

use crate::error::RecordingError;
use crate::format::Header;
use crate::reader::{Completeness, Reader};
use crate::timing::Timing;

/// Treatment of a recording that ends early.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IfPartial {
    /// It is an error.
    Refuse,
    /// Return of the complete frames returned.
    Take,
}

/// A recording in memory.
///
/// ```
/// use percept_recording::{Completeness, Header, IfPartial, Reader, Recording, Writer};
/// use vision_models::Percept;
///
/// let mut writer = Writer::new(Vec::new(), &Header::default())?;
/// writer.write(&Percept { time: 0.05, body: None, action: None, surface: None })?;
/// let bytes = writer.finish()?;
///
/// let recording = Recording::read(Reader::new(bytes.as_slice())?, IfPartial::Refuse)?;
/// assert_eq!(recording.completeness, Completeness::Complete);
/// # Ok::<(), percept_recording::RecordingError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// Data of the whole recording.
    pub header: Header,
    /// The camera frames, at least one.
    pub percepts: Vec<Percept>,
    /// The other people in each frame.
    pub others: Vec<Vec<Body>>,
    /// Times at which the parts of each percept were seen and known.
    pub timings: Vec<Timing>,
    /// Completeness of the recording.
    pub completeness: Completeness,
}

impl Recording {
    /// Reads a recording to its end.
    ///
    /// # Errors
    /// The first error of the reader. An early end is no error if `if_partial` allows it and there
    /// is at least one frame.
    pub fn read<R: BufRead>(
        mut reader: Reader<R>,
        if_partial: IfPartial,
    ) -> Result<Self, RecordingError> {
        let (mut percepts, mut others, mut timings) = (Vec::new(), Vec::new(), Vec::new());
        while let Some(percept) = reader.next() {
            match percept {
                Ok(percept) => {
                    percepts.push(percept);
                    others.push(reader.others().to_vec());
                    timings.push(reader.timing());
                }
                Err(error) => {
                    let taken = if_partial == IfPartial::Take && error.is_early_end();
                    if !taken || percepts.is_empty() {
                        return Err(error);
                    }
                }
            }
        }
        let (header, completeness) = (*reader.header(), reader.completeness());
        Ok(Self { header, percepts, others, timings, completeness })
    }
}
