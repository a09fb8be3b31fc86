//! Reads a recording line by line.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

use nalgebra::Point3;
use serde::de::DeserializeOwned;
use serde_json::Value;
use vision_models::file::Excerpt;
use vision_models::{
    Action, Body, Body25, Keypoint, Percept, PersonId, RecognisedAction, RecognisedSurface, Surface,
};

use crate::check;
use crate::error::RecordingError;
use crate::format::{
    EndLine, FORMAT, FrameLine, Header, HeaderLine, Label, UNMARKED_VERSION, VERSION,
};
use crate::lines::{Line, Lines};
use crate::timing::{Stamp, Timing};

/// The completeness of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Completeness {
    /// The closing line says that it is complete.
    Complete,
    /// The recording has version 1, which has no closing line. It may be truncated.
    Unmarked,
    /// The recording was interrupted or is truncated.
    Partial,
}

/// Opens a recording and reads its header.
///
/// # Errors
/// [`RecordingError::Open`] if the file cannot be opened, and those of [`Reader::new`].
pub fn open(path: impl AsRef<Path>) -> Result<Reader<BufReader<File>>, RecordingError> {
    let path = path.as_ref();
    let file = File::open(path)
        .map_err(|source| RecordingError::Open { path: path.to_owned(), source })?;
    Reader::new(BufReader::new(file))
}

/// Reads a recording as an iterator over its percepts, one line at a time. It ends after the first
/// error. The last item of a recording that ends early is an error for which
/// [`RecordingError::is_early_end`] is true.
///
/// ```
/// use percept_recording::Reader;
///
/// let text = concat!(
///     r#"{"format":"moca-recording","version":2,"frame":"world","rate":20.0}"#, "\n",
///     r#"{"time":0.0,"keypoints":[],"action":null,"surface":null}"#, "\n",
/// );
/// let mut reader = Reader::new(text.as_bytes())?;
/// let error = reader.next().expect("a line").unwrap_err();
/// assert!(error.to_string().starts_with("line 2: the number of keypoints is 0: give the 25 of BODY_25"));
/// assert!(reader.next().is_none());
/// # Ok::<(), percept_recording::RecordingError>(())
/// ```
#[derive(Debug)]
pub struct Reader<R> {
    lines: Lines<R>,
    header: Header,
    version: u32,
    frames: u64,
    previous: Option<f64>,
    others: Vec<Body>,
    timing: Timing,
    /// None before the end.
    end: Option<Completeness>,
}

impl<R: BufRead> Reader<R> {
    /// Reads the header.
    ///
    /// # Errors
    /// [`RecordingError::Empty`], [`RecordingError::Header`], [`RecordingError::LineTooLong`] or
    /// [`RecordingError::Io`].
    pub fn new(input: R) -> Result<Self, RecordingError> {
        let mut lines = Lines::new(input);
        let Some(line) = lines.next()? else {
            return Err(RecordingError::Empty { lines: 0 });
        };
        let (header, version) = parse_header(&line)?;
        Ok(Self {
            lines,
            header,
            version,
            frames: 0,
            previous: None,
            others: Vec::new(),
            timing: Timing::default(),
            end: None,
        })
    }

    /// Returns the data of the whole recording.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// Returns whether the recording is complete. It is partial before the end of the iterator, and
    /// after an error.
    pub fn completeness(&self) -> Completeness {
        self.end.unwrap_or(Completeness::Partial)
    }

    /// Returns when each part of the latest percept was seen and known.
    pub fn timing(&self) -> Timing {
        self.timing
    }

    /// Returns the other people in the frame of the latest percept.
    pub fn others(&self) -> &[Body] {
        &self.others
    }

    fn read(&mut self) -> Result<Option<Percept>, RecordingError> {
        let Some(line) = self.lines.next()? else {
            return self.end_of_input();
        };
        if is_closing(&line) {
            let EndLine { end } = parse(&line, self.frames, |_, problem| RecordingError::End {
                line: line.number,
                problem,
            })?;
            let number = line.number;
            return self.close(number, end.frames, end.complete);
        }
        let (percept, others, timing) = parse_frame(&line, self.frames, self.previous)?;
        (self.others, self.timing) = (others, timing);
        self.previous = Some(percept.time);
        self.frames += 1;
        Ok(Some(percept))
    }

    /// Ends the recording if there is no closing line.
    fn end_of_input(&mut self) -> Result<Option<Percept>, RecordingError> {
        let (lines, frames) = (self.lines.count(), self.frames);
        if self.version != UNMARKED_VERSION {
            return Err(RecordingError::Cut { line: lines + 1, frames });
        }
        if frames == 0 {
            return Err(RecordingError::Empty { lines });
        }
        self.end = Some(Completeness::Unmarked);
        Ok(None)
    }

    /// Ends the recording at a closing line.
    fn close(
        &mut self,
        line: usize,
        said: u64,
        complete: bool,
    ) -> Result<Option<Percept>, RecordingError> {
        let found = self.frames;
        if self.version == UNMARKED_VERSION {
            let problem = format!("the header says version {UNMARKED_VERSION}, which has no end");
            return Err(RecordingError::End { line, problem });
        }
        if said != found {
            let problem = format!(
                "the closing line gives {said} camera frame(s), and there are {found}: lines were \
                 lost or added"
            );
            return Err(RecordingError::End { line, problem });
        }
        if let Some(line) = self.lines.next()? {
            let problem = "this comes after the closing line, and a file holds one recording";
            return Err(RecordingError::End { line: line.number, problem: problem.to_owned() });
        }
        if !complete {
            return Err(RecordingError::Interrupted { line, frames: found });
        }
        if found == 0 {
            return Err(RecordingError::Empty { lines: line });
        }
        self.end = Some(Completeness::Complete);
        Ok(None)
    }
}

impl<R: BufRead> Iterator for Reader<R> {
    type Item = Result<Percept, RecordingError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.end.is_some() {
            return None;
        }
        let item = self.read().transpose();
        if matches!(item, Some(Err(_))) {
            self.end = Some(Completeness::Partial);
        }
        item
    }
}

/// Returns true if a line begins like the closing line.
fn is_closing(line: &Line<'_>) -> bool {
    line.text.strip_prefix(b"{").is_some_and(|rest| rest.trim_ascii_start().starts_with(b"\"end\""))
}

/// Parses a line after the header. `fail` creates an error from the column and the problem. If the
/// last line is incomplete, the recording is truncated after `frames` frames.
fn parse<T: DeserializeOwned>(
    line: &Line<'_>,
    frames: u64,
    fail: impl FnOnce(usize, String) -> RecordingError,
) -> Result<T, RecordingError> {
    serde_json::from_slice(line.text).map_err(|error| {
        if !line.terminated && error.is_eof() {
            RecordingError::Cut { line: line.number, frames }
        } else {
            fail(error.column(), problem(&error))
        }
    })
}

/// Returns the parser's problem without its place. The caller adds the place, with the line's
/// number in the file.
fn problem(error: &serde_json::Error) -> String {
    let problem = error.to_string();
    let place = format!(" at line {} column {}", error.line(), error.column());
    Excerpt(problem.strip_suffix(&place).unwrap_or(&problem)).to_string()
}

fn parse_header(line: &Line<'_>) -> Result<(Header, u32), RecordingError> {
    let fail = |problem| RecordingError::Header { line: line.number, problem };
    let HeaderLine { format, version, frame, rate, stature, segments } =
        serde_json::from_slice(line.text).map_err(|error| fail(problem(&error)))?;
    if format != FORMAT || !(version == VERSION || version == UNMARKED_VERSION) {
        return Err(fail(format!(
            "format \"{}\" version {version} is not \"{FORMAT}\" version {VERSION} or \
             {UNMARKED_VERSION}",
            Excerpt(&format)
        )));
    }
    Ok((check::header(line.number, Header { frame, rate, stature, segments })?, version))
}

fn parse_frame(
    line: &Line<'_>,
    frames: u64,
    previous: Option<f64>,
) -> Result<(Percept, Vec<Body>, Timing), RecordingError> {
    let number = line.number;
    let frame: FrameLine = parse(line, frames, |column, problem| RecordingError::Json {
        line: number,
        column,
        problem,
    })?;
    let line = number;
    let time = check::time(line, frame.time, previous)?;
    let ids = frame.ids.unwrap_or_else(|| vec![None; 1 + frame.others.len()]);
    check::ids(line, &ids, 1 + frame.others.len())?;
    let mut ids = ids.into_iter().map(|id| id.map(PersonId::new));
    let mut known = |body: Option<Body>| {
        let id = ids.next().flatten();
        body.map(|body| body.with_id(id))
    };
    let body = known(body(line, &frame.keypoints)?);
    let others = frame
        .others
        .iter()
        .zip(1..)
        .map(|(keypoints, person)| body_of_other(line, keypoints, person).map(&mut known));
    let others: Vec<Option<Body>> = others.collect::<Result<_, _>>()?;
    let stamp = |of, label: &Option<Label>| {
        let stamp = label.as_ref().map(|label| (label.captured, label.arrived)).unwrap_or_default();
        check::stamp(line, of, Stamp { captured: stamp.0, arrived: stamp.1 }, time)
    };
    let of_body = Stamp { captured: None, arrived: frame.arrived };
    let timing = Timing {
        arrived: check::stamp(line, "body", of_body, time)?.arrived,
        action: stamp("action", &frame.action)?,
        surface: stamp("surface", &frame.surface)?,
    };
    let percept = Percept {
        time,
        body,
        action: frame.action.map(|label| action(line, &label)).transpose()?,
        surface: frame.surface.map(|label| surface(line, &label)).transpose()?,
    };
    Ok((percept, others.into_iter().flatten().collect(), timing))
}

/// Returns the body with these keypoints, or none if no joint was seen.
fn body(line: usize, keypoints: &[Value]) -> Result<Option<Body>, RecordingError> {
    if keypoints.len() != Body25::COUNT {
        return Err(RecordingError::Value {
            line,
            what: "the number of keypoints".to_owned(),
            got: keypoints.len().to_string(),
            wanted: "the 25 of BODY_25 in OpenPose's order, null for those that were not seen"
                .to_owned(),
        });
    }
    let mut body = Body::default();
    for (joint, value) in Body25::ALL.into_iter().zip(keypoints) {
        body.set(joint, keypoint(line, joint, value)?);
    }
    Ok(Some(body).filter(|body| body.iter().next().is_some()))
}

fn body_of_other(
    line: usize,
    keypoints: &[Value],
    person: usize,
) -> Result<Option<Body>, RecordingError> {
    body(line, keypoints).map_err(|error| check::of_other(error, person))
}

fn keypoint(line: usize, joint: Body25, value: &Value) -> Result<Option<Keypoint>, RecordingError> {
    if value.is_null() {
        return Ok(None);
    }
    let numbers = value.as_array().map(|values| values.iter().map(Value::as_f64));
    let numbers: Option<Vec<f64>> = numbers.and_then(Iterator::collect);
    let Some(&[x, y, z, confidence]) = numbers.as_deref() else {
        return Err(RecordingError::Value {
            line,
            what: check::keypoint(joint),
            got: Excerpt(&value.to_string()).to_string(),
            wanted: "[x, y, z, confidence] with the position in metres, or null if it was not seen"
                .to_owned(),
        });
    };
    Ok(Some(Keypoint {
        position: check::position(line, joint, Point3::new(x, y, z))?,
        confidence: check::confidence(line, || check::keypoint(joint), confidence)?,
    }))
}

fn action(line: usize, label: &Label) -> Result<RecognisedAction, RecordingError> {
    Ok(RecognisedAction {
        action: Action::from_name(&Excerpt(&label.name).to_string())
            .map_err(|source| RecordingError::Name { line, source: Box::new(source) })?,
        confidence: check::confidence(line, || "the action".to_owned(), label.confidence)?,
    })
}

fn surface(line: usize, label: &Label) -> Result<RecognisedSurface, RecordingError> {
    let surface: Result<Surface, _> = Excerpt(&label.name).to_string().parse();
    Ok(RecognisedSurface {
        surface: surface
            .map_err(|source| RecordingError::Name { line, source: Box::new(source) })?,
        confidence: check::confidence(line, || "the surface".to_owned(), label.confidence)?,
    })
}
