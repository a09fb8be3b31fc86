//! Reading a recording, line by line.

use std::io::{BufRead, Read};

use nalgebra::Point3;
use serde::de::DeserializeOwned;
use serde_json::Value;
use vision_models::{
    Action, Body, Body25, Keypoint, Percept, RecognisedAction, RecognisedSurface, Surface,
};

use super::{
    RecordingError, check,
    format::{FORMAT, FrameLine, Header, HeaderLine, Label, VERSION},
};

/// The most that is read of one line (bytes).
const LONGEST_LINE: usize = 64 * 1024;

/// Reads a recording as an iterator over its percepts, one line at a time. After the first error
/// it ends.
///
/// ```
/// use examples::recording::Reader;
///
/// let text = concat!(
///     r#"{"format":"moca-recording","version":1,"frame":"world","rate":20.0}"#, "\n",
///     r#"{"time":0.0,"keypoints":[],"action":null,"surface":null}"#, "\n",
/// );
/// let mut reader = Reader::new(text.as_bytes())?;
/// let error = reader.next().expect("a line").unwrap_err();
/// assert!(error.to_string().starts_with("line 2: 0 keypoints: give the 25 of BODY_25"));
/// assert!(reader.next().is_none());
/// # Ok::<(), examples::recording::RecordingError>(())
/// ```
#[derive(Debug)]
pub struct Reader<R> {
    lines: Lines<R>,
    header: Header,
    previous: Option<f64>,
    ended: bool,
}

impl<R: BufRead> Reader<R> {
    /// Reads the header.
    ///
    /// # Errors
    /// [`RecordingError::Empty`], [`RecordingError::Header`], [`RecordingError::LineTooLong`] or
    /// [`RecordingError::Io`].
    pub fn new(input: R) -> Result<Self, RecordingError> {
        let mut lines = Lines { input, buffer: Vec::new(), number: 0 };
        let Some((line, text)) = lines.next()? else {
            return Err(RecordingError::Empty { lines: 0 });
        };
        let header = parse_header(line, text)?;
        Ok(Self { lines, header, previous: None, ended: false })
    }

    /// What holds for the whole recording.
    pub fn header(&self) -> &Header {
        &self.header
    }

    fn read(&mut self) -> Result<Option<Percept>, RecordingError> {
        let Some((line, text)) = self.lines.next()? else {
            return match self.previous {
                Some(_) => Ok(None),
                None => Err(RecordingError::Empty { lines: self.lines.number }),
            };
        };
        let percept = parse_frame(line, text, self.previous)?;
        self.previous = Some(percept.time);
        Ok(Some(percept))
    }
}

impl<R: BufRead> Iterator for Reader<R> {
    type Item = Result<Percept, RecordingError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        let item = self.read().transpose();
        self.ended = !matches!(item, Some(Ok(_)));
        item
    }
}

/// The lines of the input that are not blank, of bounded length, with their numbers.
#[derive(Debug)]
struct Lines<R> {
    input: R,
    buffer: Vec<u8>,
    number: usize,
}

impl<R: BufRead> Lines<R> {
    fn next(&mut self) -> Result<Option<(usize, &[u8])>, RecordingError> {
        loop {
            self.buffer.clear();
            let line = self.number + 1;
            let read = self
                .input
                .by_ref()
                .take(LONGEST_LINE as u64 + 1)
                .read_until(b'\n', &mut self.buffer)
                .map_err(|source| RecordingError::Io { line, source })?;
            if read == 0 {
                return Ok(None);
            }
            if read > LONGEST_LINE {
                return Err(RecordingError::LineTooLong { line, limit: LONGEST_LINE });
            }
            self.number = line;
            if !self.buffer.trim_ascii().is_empty() {
                return Ok(Some((line, self.buffer.trim_ascii())));
            }
        }
    }
}

/// Parses one line; a failure gives the column and what was found there.
fn parse<T: DeserializeOwned>(text: &[u8]) -> Result<T, (usize, String)> {
    serde_json::from_slice(text).map_err(|error| {
        let problem = error.to_string();
        // The place is said once, by whoever reports it, with the line's number in the file.
        let place = format!(" at line {} column {}", error.line(), error.column());
        (error.column(), problem.strip_suffix(&place).unwrap_or(&problem).to_owned())
    })
}

fn parse_header(line: usize, text: &[u8]) -> Result<Header, RecordingError> {
    let fail = |problem| RecordingError::Header { line, problem };
    let found: HeaderLine = parse(text).map_err(|(_, problem)| fail(problem))?;
    if found.format != FORMAT || found.version != VERSION {
        let HeaderLine { format, version, .. } = found;
        return Err(fail(format!(
            "format \"{format}\" version {version} is not \"{FORMAT}\" version {VERSION}"
        )));
    }
    let HeaderLine { frame, rate, stature, .. } = found;
    check::header(line, Header { frame, rate, stature })
}

fn parse_frame(line: usize, text: &[u8], previous: Option<f64>) -> Result<Percept, RecordingError> {
    let frame: FrameLine =
        parse(text).map_err(|(column, problem)| RecordingError::Json { line, column, problem })?;
    let time = check::time(line, frame.time, previous)?;
    if frame.keypoints.len() != Body25::COUNT {
        return Err(RecordingError::KeypointCount { line, found: frame.keypoints.len() });
    }
    let mut body = Body::default();
    for (joint, value) in Body25::ALL.into_iter().zip(&frame.keypoints) {
        body.set(joint, keypoint(line, joint, value)?);
    }
    Ok(Percept {
        time,
        body: Some(body).filter(|body| body.iter().next().is_some()),
        action: frame.action.map(|label| action(line, &label)).transpose()?,
        surface: frame.surface.map(|label| surface(line, &label)).transpose()?,
    })
}

fn keypoint(line: usize, joint: Body25, value: &Value) -> Result<Option<Keypoint>, RecordingError> {
    if value.is_null() {
        return Ok(None);
    }
    let numbers = value.as_array().map(|values| values.iter().map(Value::as_f64));
    let numbers: Option<Vec<f64>> = numbers.and_then(Iterator::collect);
    let Some(&[x, y, z, confidence]) = numbers.as_deref() else {
        return Err(RecordingError::Keypoint {
            line,
            index: joint.index(),
            joint: joint.name(),
            found: value.to_string().chars().take(80).collect(),
        });
    };
    let of = || format!("keypoint {} ({})", joint.index(), joint.name());
    Ok(Some(Keypoint {
        position: check::position(line, joint, Point3::new(x, y, z))?,
        confidence: check::confidence(line, of, confidence)?,
    }))
}

fn action(line: usize, label: &Label) -> Result<RecognisedAction, RecordingError> {
    Ok(RecognisedAction {
        action: Action::from_name(&label.name)
            .map_err(|source| RecordingError::Name { line, source })?,
        confidence: check::confidence(line, || "the action".to_owned(), label.confidence)?,
    })
}

fn surface(line: usize, label: &Label) -> Result<RecognisedSurface, RecordingError> {
    let surface: Result<Surface, _> = label.name.parse();
    Ok(RecognisedSurface {
        surface: surface.map_err(|source| RecordingError::Name { line, source })?,
        confidence: check::confidence(line, || "the surface".to_owned(), label.confidence)?,
    })
}
