//! Memory of a workcell, to be played again.

use std::collections::VecDeque;
use std::io::Write;
use std::sync::Arc;

use percept_recording::{Header, RecordingError, Timing, Writer};
use simulated_people::{FRAME_RATE, Joints};
use vision_models::{Body, Confidence, Keypoint, Percept};

/// Length of the memory \[s\].
const SPAN: f64 = 300.0;

/// A camera frame as it arrived.
#[derive(Clone, Debug, PartialEq)]
pub struct Remembered {
    /// The person who works with the robot.
    pub percept: Percept,
    /// Other people.
    pub others: Vec<Body>,
    /// Time of arrival \[s\].
    pub arrived: f64,
}

/// The last five minutes: what the robot saw, and where the person truly was. Its clones share what they hold.
#[derive(Clone, Debug, Default)]
pub struct Memory {
    stature: f64,
    frames: VecDeque<Arc<Remembered>>,
    truth: VecDeque<Arc<(f64, Joints)>>,
}

impl Memory {
    /// Remembers nothing yet of a person of a stature \[m\].
    pub fn new(stature: f64) -> Self {
        Self { stature, ..Self::default() }
    }

    /// Takes a frame that has arrived.
    pub fn see(&mut self, frame: Remembered) {
        let oldest = frame.percept.time - SPAN;
        self.frames.push_back(Arc::new(frame));
        while self.frames.front().is_some_and(|frame| frame.percept.time < oldest) {
            self.frames.pop_front();
        }
    }

    /// Takes where the person truly is at a time \[s, m\].
    pub(crate) fn witness(&mut self, time: f64, joints: &Joints) {
        self.truth.push_back(Arc::new((time, *joints)));
        while self.truth.front().is_some_and(|first| first.0 < time - SPAN) {
            self.truth.pop_front();
        }
    }

    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.frames.len()
    }

    /// Writes what the robot saw as a recording, and gives the output back.
    ///
    /// # Errors
    /// Those of the output.
    pub fn write_recording<W: Write>(&self, output: W) -> Result<W, RecordingError> {
        let mut writer = Writer::new(output, &self.header(FRAME_RATE))?;
        for frame in &self.frames {
            let Remembered { percept, others, arrived } = &**frame;
            let timing = Timing { arrived: Some(*arrived), ..Timing::default() };
            writer.write_people(percept, others, &timing)?;
        }
        writer.finish()
    }

    /// Writes where the person truly was during those frames as a recording, and gives the output back.
    ///
    /// # Errors
    /// Those of the output.
    pub fn write_truth<W: Write>(&self, output: W) -> Result<W, RecordingError> {
        let mut writer = Writer::new(output, &self.header(TRUE_RATE))?;
        for moment in &self.truth {
            let (time, joints) = &**moment;
            let seen = |position| Some(Keypoint { position, confidence: Confidence::ONE });
            let body = Some(Body::new(joints.map(seen)));
            writer.write(&Percept { time: *time, body, action: None, surface: None })?;
        }
        writer.finish()
    }

    fn header(&self, rate: f64) -> Header {
        Header { rate, stature: Some(self.stature), ..Header::default() }
    }
}

/// Rate at which the truth is remembered \[Hz\].
pub(super) const TRUE_RATE: f64 = 50.0;
