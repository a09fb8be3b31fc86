//! The camera of a loop, and the reader of its ticks.

use std::fmt;
use std::io::BufRead;
use std::sync::mpsc::SyncSender;
use std::thread;

use anyhow::Result;
use ergo_map::{ErgonomicsMap, PersonFrame};
use moca_drivers::{Logbook, LoopTick, RecordedCamera, Ticks};
use moca_model::{Acknowledgement, Scene};
use moca_simulation::run::{Encounter, RobotView, Scenario, Scorer};
use nalgebra::{Isometry3, Vector3};

use super::records::Records;
use crate::program::{ProgramError, Session};

/// Shows a loop its camera frames, and keeps and tells what it does.
pub struct Attendant<'a> {
    session: &'a Session,
    scenario: &'a Scenario,
    ticks: Ticks,
    frames: SyncSender<Scene>,
    book: Logbook,
    acknowledgement: Acknowledgement,
    scorer: Scorer<&'a ErgonomicsMap>,
    encounter: Encounter,
    robot: RobotView,
    records: Option<Records>,
    /// The first failure of a file, which does not end the loop.
    failure: Option<anyhow::Error>,
}

impl fmt::Debug for Attendant<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Attendant").field("book", &self.book).finish_non_exhaustive()
    }
}

impl<'a> Attendant<'a> {
    /// Creates the attendant of a loop with these ticks, which takes its camera frames there.
    pub fn new(
        session: &'a Session,
        scenario: &'a Scenario,
        (ticks, frames, acknowledgement): (Ticks, SyncSender<Scene>, Acknowledgement),
        records: Option<Records>,
    ) -> Self {
        let robot = RobotView {
            camera: scenario.settings.on_board_camera,
            base: [0.0; 3],
            tool: Isometry3::identity(),
            holds: false,
        };
        Self {
            session,
            scenario,
            ticks,
            frames,
            book: Logbook::default(),
            acknowledgement,
            scorer: Scorer::new(&scenario.map),
            encounter: Encounter::new(scenario),
            robot,
            records,
            failure: None,
        }
    }

    /// The camera that plays the recording.
    pub fn camera(&self) -> RecordedCamera {
        RecordedCamera::new(self.scenario.scenes())
    }

    /// Reads the ticks that have come.
    pub fn attend(&mut self) {
        let Self { session, book, scorer, encounter, robot, scenario, records, failure, .. } = self;
        self.ticks.read(|tick| {
            if let Some(news) = book.push(tick) {
                session.note(news);
            }
            let object = Some(Vector3::from(tick.row.actual)).filter(|_| tick.row.collaborating);
            encounter.advance(tick.row.time, scenario.settings.period, object);
            (robot.tool, robot.holds) = (tick.tool, tick.holds);
            for (own, value) in robot.base.iter_mut().zip(&tick.row.q) {
                *own = *value;
            }
            if let Some(kept) = records {
                score(scorer, tick);
                let written = kept.tick(&tick.row);
                keep(records, failure, written);
            }
        });
    }

    /// Acknowledges the stop that waits for it.
    pub fn acknowledge(&self) {
        self.acknowledgement.give();
    }

    /// The phase and the safety state, each with its cause.
    pub fn state(&self) -> String {
        self.book.state()
    }

    /// Shows the loop a recorded frame as its cameras see it.
    pub fn show(&mut self, mut frame: Scene) {
        match self.encounter.show(&frame.percept, &self.robot) {
            Ok(percept) => {
                frame.percept = percept;
                self.see(frame);
            }
            Err(error) => self.failure = Some(error.into()),
        }
    }

    /// Gives the loop a frame.
    pub fn see(&mut self, frame: Scene) {
        if let Some(kept) = &mut self.records {
            let written = kept.see(&frame);
            keep(&mut self.records, &mut self.failure, written);
        }
        // A loop that reads no frames for a while misses them.
        let _ = self.frames.try_send(frame);
    }

    /// Puts the files in their places. Returns the phases and states of the loop.
    ///
    /// # Errors
    /// The first failure of a file.
    pub fn finish(mut self) -> Result<Logbook> {
        self.attend();
        if let Some(error) = self.failure {
            return Err(error);
        }
        self.records.map_or(Ok(()), |records| records.finish(&self.book))?;
        Ok(self.book)
    }
}

/// Lets each line of standard input acknowledge a stop.
///
/// # Errors
/// Standard input without a thread to read it.
pub fn acknowledge_by_keys(session: &Session, by: Acknowledgement) -> Result<(), ProgramError> {
    let input = session.standard_input()?;
    let read = move || input.lines().map_while(Result::ok).for_each(|_| by.give());
    let started = thread::Builder::new().spawn(read);
    started.map(drop).map_err(|source| ProgramError::Refused { what: "another thread", source })
}

/// Gives up the files after a failure, of which the loop takes no notice.
fn keep(records: &mut Option<Records>, failure: &mut Option<anyhow::Error>, written: Result<()>) {
    if let Err(error) = written {
        *records = None;
        failure.get_or_insert(error);
    }
}

/// Adds the scores of the person, with the hand at what the robot holds.
fn score(scorer: &Scorer<&ErgonomicsMap>, tick: &mut LoopTick) {
    let Some(person) = &tick.person else { return };
    let floor = Vector3::new(person.floor.x, person.floor.y, 0.0);
    let hand = PersonFrame::new(floor, person.heading).ok();
    let hand = hand.and_then(|frame| scorer.score(&frame, &tick.row.actual.into()));
    (tick.row.score, tick.row.reba) = hand.map_or((0.0, 0), |hand| (hand.score, hand.reba));
}
