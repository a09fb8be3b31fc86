//! Frames whose truth is known: a folder of frames with a recording of the truth.

use std::path::{Path, PathBuf};

use percept_recording::{IfPartial, Recording, RecordingError};
use vision_models::Percept;

use super::{format::FrameEntry, reader::FramesReader};
use crate::error::Error;

/// Name of the recording of the truth in a folder of frames.
pub const TRUTH: &str = "truth.jsonl";

/// Largest time difference of a frame and its truth (s). Times are written to the microsecond.
const SAME_TIME: f64 = 2e-6;

/// A folder of frames with the truth of each.
#[derive(Debug)]
pub struct TrueFilm {
    /// Name of the folder itself.
    pub name: String,
    /// The frames in order, each with its truth.
    pub frames: Vec<(FrameEntry, Percept)>,
    reader: FramesReader,
}

impl TrueFilm {
    /// Reads the index and the truth.
    ///
    /// # Errors
    /// Names the file that cannot be used, or the frame without a truth.
    pub fn open(folder: &Path) -> Result<Self, Error> {
        let mut reader = FramesReader::open(folder, std::time::Duration::ZERO)?;
        let file = folder.join(TRUTH);
        let mut truth = read(&file)?.into_iter().peekable();
        let mut frames = Vec::new();
        while let Some(entry) = reader.next_entry(|| false)? {
            while truth.next_if(|percept| percept.time < entry.time - SAME_TIME).is_some() {}
            let at_time = truth.next_if(|percept| percept.time <= entry.time + SAME_TIME);
            let Some(percept) = at_time else {
                let found = format!("nothing of frame {} at {} s", entry.frame, entry.time);
                return Err(Error::at(file.display(), found));
            };
            frames.push((entry, percept));
        }
        let name = folder.canonicalize().map_err(Error::read(folder))?;
        let name = name.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Self { name, frames, reader })
    }

    /// Reads several folders with different names, so that their frames can be distinguished by
    /// name.
    ///
    /// # Errors
    /// Those of [`Self::open`], and an error if two have the same name.
    pub(crate) fn open_all(folders: &[PathBuf]) -> Result<Vec<Self>, Error> {
        let films =
            folders.iter().map(|folder| Self::open(folder)).collect::<Result<Vec<_>, _>>()?;
        for (place, film) in films.iter().enumerate() {
            let twice = films.iter().take(place).any(|other| other.name == film.name);
            if twice {
                let place = format!("two folders are called \"{}\"", film.name);
                return Err(Error::at(place, "give each another name"));
            }
        }
        Ok(films)
    }

    /// Returns the reader, which has the paths of the frames' files.
    pub fn reader(&self) -> &FramesReader {
        &self.reader
    }
}

/// Reads the percepts of a recording of the truth.
///
/// # Errors
/// Names the file if it cannot be read or is not complete.
pub fn read(file: &Path) -> Result<Vec<Percept>, Error> {
    let named = |error: RecordingError| match error {
        RecordingError::Open { path, source } => Error::Read { path, source },
        source => Error::Truth { path: file.to_owned(), source: Box::new(source) },
    };
    let reader = percept_recording::open(file).map_err(named)?;
    Ok(Recording::read(reader, IfPartial::Refuse).map_err(named)?.percepts)
}
