//! Records of a loop's inputs and commands, in files.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use moca_drivers::Logbook;
use moca_model::whole_body::Model;
use moca_model::whole_body::robot::JointKind;
use moca_model::{MOCA_JOINTS, Scene};
#[cfg(feature = "mcap")]
use moca_replay::mcap::RobotLog;
use moca_replay::report::{MOCA_COLUMNS, RunLog, TickRow, TickTable, figure};
use moca_simulation::run::Scenario;
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
    #[cfg(feature = "mcap")]
    robot: RobotRows,
}

/// Ticks of the robot at 100 Hz, for MCAP.
#[cfg(feature = "mcap")]
#[derive(Debug)]
struct RobotRows {
    model: Model,
    rows: Vec<TickRow>,
}

/// Time between two ticks that MCAP holds \[s\].
#[cfg(feature = "mcap")]
const KEPT: f64 = 0.01;

impl Records {
    /// Creates the files, and the folder if it does not exist, for this robot and a person.
    ///
    /// # Errors
    /// A folder in which nothing can be written.
    pub fn create(folder: &Path, scenario: &Scenario) -> Result<Self> {
        check_folder(folder)?;
        fs::create_dir_all(folder)
            .with_context(|| format!("cannot make the folder {}", folder.display()))?;
        let file = |name: &str| OutputFile::create(folder.join(name));
        let header = Header { stature: Some(scenario.map.stature()), ..Header::default() };
        Ok(Self {
            recording: Writer::new(file("recording.jsonl")?, &header)?,
            last: None,
            ticks: TickTable::new(file("ticks.csv")?, &columns(&scenario.model))?,
            log: RunLog::new("The robot's loop"),
            #[cfg(feature = "mcap")]
            robot: RobotRows { model: scenario.model.clone(), rows: Vec::new() },
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
        #[cfg(feature = "mcap")]
        self.robot.push(row);
        Ok(self.ticks.write(row)?)
    }

    /// Puts the files in their places, with the states of the loop in MCAP. A loop that did not come to its end leaves them whole as well: they end with it.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn finish(self, book: &Logbook) -> Result<()> {
        let Self { folder, recording, ticks, log, .. } = self;
        recording.finish()?.keep()?;
        #[cfg(feature = "mcap")]
        self.robot.write(&folder, book)?;
        #[cfg(not(feature = "mcap"))]
        let _ = book;
        ticks.finish()?.keep()?;
        // There is no figure of a loop without a tick.
        if let Ok(figure) = figure(&[&log]) {
            OutputFile::write_whole(folder.join("drive.svg"), figure.as_bytes())?;
        }
        Ok(())
    }
}

/// The columns of a robot's joints, with their units.
fn columns(model: &Model) -> Vec<(&str, &str)> {
    let joints = model.joints();
    if joints.iter().map(|joint| &*joint.name).eq(MOCA_JOINTS) {
        return MOCA_COLUMNS.to_vec();
    }
    let unit = |kind| if kind == JointKind::Prismatic { "m" } else { "rad" };
    joints.iter().map(|joint| (&*joint.name, unit(joint.kind))).collect()
}

#[cfg(feature = "mcap")]
impl RobotRows {
    fn push(&mut self, row: &TickRow) {
        if self.rows.last().is_none_or(|last| row.time + 0.5e-3 >= last.time + KEPT) {
            self.rows.push(row.clone());
        }
    }

    /// Writes drive.mcap: the recording of the folder, the robot's motion, and the states of the loop.
    fn write(self, folder: &Path, book: &Logbook) -> Result<()> {
        let recording = fs::read(folder.join("recording.jsonl"))?;
        let mut log = RobotLog::new(&recording, &self.model)?;
        self.rows.iter().try_for_each(|row| log.push(row))?;
        let first = book.first().unwrap_or_default();
        [&book.phase, &book.safety]
            .into_iter()
            .try_for_each(|lane| log.push_states(lane, first))?;
        Ok(OutputFile::write_whole(folder.join("drive.mcap"), &log.finish()?)?)
    }
}
