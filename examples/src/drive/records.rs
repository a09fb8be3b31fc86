//! What a loop sees and does, in files.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use moca_model::Scene;
use moca_replay::report::{MOCA_COLUMNS, RunLog, TickRow, TickTable, figure};
use percept_recording::{Header, Timing, Writer};

use crate::program::{OutputFile, check_folder};

/// Least time between two frames of a recording \[s\], which has microseconds.
const APART: f64 = 2e-6;

/// The files of a folder: the camera frames as a recording, every tick as a table, and a figure.
#[derive(Debug)]
pub struct Records {
    folder: PathBuf,
    recording: Writer<OutputFile>,
    last: Option<f64>,
    ticks: TickTable<OutputFile>,
    log: RunLog,
}

impl Records {
    /// Creates the files, and the folder if it does not exist, for a person of this stature \[m\].
    ///
    /// # Errors
    /// A folder in which nothing can be written.
    pub fn create(folder: &Path, stature: f64) -> Result<Self> {
        check_folder(folder)?;
        fs::create_dir_all(folder)
            .with_context(|| format!("cannot make the folder {}", folder.display()))?;
        let file = |name: &str| OutputFile::create(folder.join(name));
        let header = Header { stature: Some(stature), ..Header::default() };
        Ok(Self {
            recording: Writer::new(file("recording.jsonl")?, &header)?,
            last: None,
            ticks: TickTable::new(file("ticks.csv")?, &MOCA_COLUMNS)?,
            log: RunLog::new("The robot's loop"),
            folder: folder.to_owned(),
        })
    }

    /// Adds a camera frame. A recording has no two frames of the same time: a second one is left out.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn see(&mut self, frame: &Scene) -> Result<()> {
        let time = frame.percept.time;
        if self.last.is_none_or(|last| time > last + APART) {
            self.last = Some(time);
            self.recording.write_people(&frame.percept, frame.others(), &Timing::default())?;
        }
        Ok(())
    }

    /// Adds a tick.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn tick(&mut self, row: &TickRow) -> Result<()> {
        self.log.push(row);
        Ok(self.ticks.write(row)?)
    }

    /// Puts the files in their places. A loop that did not come to its end leaves them whole as well: they end with it.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn finish(self) -> Result<()> {
        let Self { folder, recording, ticks, log, .. } = self;
        recording.finish()?.keep()?;
        ticks.finish()?.keep()?;
        // There is no figure of a loop without a tick.
        if let Ok(figure) = figure(&[&log]) {
            OutputFile::write_whole(folder.join("drive.svg"), figure.as_bytes())?;
        }
        Ok(())
    }
}
