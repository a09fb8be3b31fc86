//! Writes a recording line by line.

use std::io::Write;

use serde::Serialize;
use vision_models::{Body, Body25, Confidence, Percept, PersonId};

use crate::check;
use crate::error::RecordingError;
use crate::format::{
    End, EndLine, FORMAT, FrameLineOut, Header, HeaderLine, KeypointsOut, LabelOut, VERSION,
};
use crate::timing::{Stamp, Timing};

/// Writes a recording.
///
/// Times are rounded to the microsecond, positions to a tenth of a millimetre, confidences to a
/// thousandth. It writes nothing that [`Reader`](crate::Reader) would reject. If the writer is
/// dropped without [`finish`](Self::finish), the recording has no closing line and counts as
/// truncated.
///
/// ```
/// use percept_recording::{Header, RecordingError, Writer};
/// use vision_models::Percept;
///
/// let mut writer = Writer::new(Vec::new(), &Header::default())?;
/// let percept = Percept { time: 1.0, body: None, action: None, surface: None };
/// writer.write(&percept)?;
/// // The same frame again: time stands still.
/// assert!(matches!(writer.write(&percept), Err(RecordingError::Value { line: 3, .. })));
/// # Ok::<(), RecordingError>(())
/// ```
#[derive(Debug)]
pub struct Writer<W> {
    output: W,
    line: usize,
    frames: u64,
    previous: Option<f64>,
}

impl<W: Write> Writer<W> {
    /// Creates a writer and writes the header.
    ///
    /// # Errors
    /// [`RecordingError::Header`] if the header is invalid, [`RecordingError::Io`] if writing
    /// fails.
    pub fn new(output: W, header: &Header) -> Result<Self, RecordingError> {
        let Header { frame, rate, stature, segments } = check::header(1, *header)?;
        let mut writer = Self { output, line: 0, frames: 0, previous: None };
        let (format, version) = (FORMAT.to_owned(), VERSION);
        writer.write_line(&HeaderLine { format, version, frame, rate, stature, segments })?;
        Ok(writer)
    }

    /// Writes a percept.
    ///
    /// # Errors
    /// The [`RecordingError`] of reading such a percept, or [`RecordingError::Io`]. The line is
    /// then not written.
    pub fn write(&mut self, percept: &Percept) -> Result<(), RecordingError> {
        self.write_people(percept, &[], &Timing::default())
    }

    /// Writes a percept with the other people in the frame, and the times at which its parts were
    /// seen and known. People without any visible joint are left out, and so are times of a missing
    /// action or surface.
    ///
    /// # Errors
    /// Those of [`write`](Self::write).
    pub fn write_people(
        &mut self,
        percept: &Percept,
        others: &[Body],
        timing: &Timing,
    ) -> Result<(), RecordingError> {
        let line = self.line + 1;
        let time = check::time(line, rounded(percept.time, 1e6), self.previous)?;
        let keypoints = match &percept.body {
            Some(body) => written(line, body)?,
            None => [None; Body25::COUNT],
        };
        let is_seen = |body: &&Body| body.iter().next().is_some();
        let seen = others.iter().filter(is_seen);
        let id = |body: &Body| body.id().map(PersonId::number);
        let worker = percept.body.as_ref().filter(is_seen).and_then(id);
        let ids: Vec<_> = std::iter::once(worker).chain(seen.clone().map(id)).collect();
        check::ids(line, &ids, ids.len())?;
        let others = seen.zip(1..).map(|(body, person)| {
            written(line, body).map_err(|error| check::of_other(error, person))
        });
        let others = others.collect::<Result<_, _>>()?;
        let stamp = |of, stamp: Stamp| {
            let round = |time: Option<f64>| time.map(|time| rounded(time, 1e6));
            let Stamp { captured, arrived } = stamp;
            let stamp = Stamp { captured: round(captured), arrived: round(arrived) };
            check::stamp(line, of, stamp, time)
        };
        let of_body = Stamp { captured: None, arrived: timing.arrived };
        let arrived = stamp("body", of_body)?.arrived;
        let of_action = stamp("action", timing.action)?;
        let of_surface = stamp("surface", timing.surface)?;
        let label =
            |name, confidence, stamp| LabelOut { name, confidence: plain(confidence), stamp };
        self.write_line(&FrameLineOut {
            time,
            arrived,
            keypoints,
            others,
            ids: ids.iter().any(Option::is_some).then_some(ids),
            action: percept
                .action
                .map(|seen| label(seen.action.name(), seen.confidence, of_action)),
            surface: percept
                .surface
                .map(|seen| label(seen.surface.name(), seen.confidence, of_surface)),
        })?;
        self.frames += 1;
        self.previous = Some(time);
        Ok(())
    }

    /// Writes the closing line of a complete recording, flushes and returns the output.
    ///
    /// # Errors
    /// [`RecordingError::Io`] if writing fails.
    pub fn finish(self) -> Result<W, RecordingError> {
        self.close(true)
    }

    /// Writes the closing line of a recording that ends early, flushes and returns the output.
    ///
    /// # Errors
    /// [`RecordingError::Io`] if writing fails.
    pub fn finish_partial(self) -> Result<W, RecordingError> {
        self.close(false)
    }

    fn close(mut self, complete: bool) -> Result<W, RecordingError> {
        self.write_line(&EndLine { end: End { frames: self.frames, complete } })?;
        let line = self.line;
        self.output.flush().map_err(|source| RecordingError::Io { line, source })?;
        Ok(self.output)
    }

    fn write_line(&mut self, content: &impl Serialize) -> Result<(), RecordingError> {
        self.line += 1;
        let fail = |source| RecordingError::Io { line: self.line, source };
        let mut text = serde_json::to_vec(content).map_err(|error| fail(error.into()))?;
        text.push(b'\n');
        self.output.write_all(&text).map_err(fail)
    }
}

/// Returns the keypoints of a body for writing.
fn written(line: usize, body: &Body) -> Result<KeypointsOut, RecordingError> {
    let mut keypoints = [None; Body25::COUNT];
    for (joint, keypoint) in body.iter() {
        let position = check::position(line, joint, keypoint.position)?;
        let [x, y, z] = position.coords.map(|value| rounded(value, 1e4)).into();
        keypoints[joint.index()] = Some([x, y, z, plain(keypoint.confidence)]);
    }
    Ok(keypoints)
}

/// Rounds to `1 / scale`, without negative zero.
fn rounded(value: f64, scale: f64) -> f64 {
    (value * scale).round() / scale + 0.0
}

fn plain(confidence: Confidence) -> f64 {
    rounded(confidence.value(), 1e3)
}
