//! Rules for every line: the reader rejects lines that break them, and the writer does not write
//! such lines.

use nalgebra::Point3;
use vision_models::file::Excerpt;
use vision_models::{Body, Body25, Confidence};

use crate::error::RecordingError;
use crate::format::Header;
use crate::timing::Stamp;

/// Longest pause between two frames (s). Time stamps in milliseconds have longer pauses.
const LONGEST_GAP: f64 = 10.0;

/// Longest time until a result is known (s): a large network on a slow machine.
const LONGEST_DELAY: f64 = 600.0;

pub(super) fn header(line: usize, header: Header) -> Result<Header, RecordingError> {
    let problem = if !(header.rate > 0.0 && header.rate <= 1000.0) {
        format!("the rate is {}: give a positive number of frames a second", header.rate)
    } else if let Some(stature) = header.stature.filter(|stature| !(0.5..=2.5).contains(stature)) {
        format!("the stature is {stature}: give metres, 0.5 to 2.5, or null")
    } else if let Some((name, length)) = wrong_segment(&header) {
        format!("the length of the {name} is {length}: give metres, 0.05 to 1.5, or leave it out")
    } else {
        return Ok(header);
    };
    Err(RecordingError::Header { line, problem })
}

/// Returns the first invalid length.
fn wrong_segment(header: &Header) -> Option<(&'static str, f64)> {
    let lengths = header.segments.to_array().into_iter();
    let mut lengths = lengths.filter_map(|(name, length)| Some((name, length?)));
    lengths.find(|(_, length)| !(0.05..=1.5).contains(length))
}

/// Checks when a part of a percept was seen and known. `time` is the frame's (s).
pub(super) fn stamp(
    line: usize,
    of: &'static str,
    stamp: Stamp,
    time: f64,
) -> Result<Stamp, RecordingError> {
    let captured = stamp.captured.unwrap_or(time);
    let arrived = stamp.arrived.unwrap_or(captured);
    let orderly = captured <= time && arrived >= captured;
    if orderly && time - captured <= LONGEST_DELAY && arrived - captured <= LONGEST_DELAY {
        return Ok(stamp);
    }
    Err(RecordingError::Value {
        line,
        what: format!("the {of} of the frame of {time} s"),
        got: format!("captured at {captured} s and arrived at {arrived} s"),
        wanted: format!(
            "a capture no later than the frame and an arrival no earlier, both within {LONGEST_DELAY} s"
        ),
    })
}

/// Checks a time stamp against the previous one, if any.
pub(super) fn time(line: usize, time: f64, previous: Option<f64>) -> Result<f64, RecordingError> {
    let (got, wanted) = match previous {
        _ if !time.is_finite() => (time.to_string(), "finite seconds".to_owned()),
        Some(previous) if time <= previous => (
            format!("{time} s, not later than {previous} s on the line before"),
            "the frames in the order in which the camera took them".to_owned(),
        ),
        Some(previous) if time - previous > LONGEST_GAP => (
            format!("{time} s, after {} s without a frame", time - previous),
            format!(
                "time stamps in seconds, and pauses of more than {LONGEST_GAP} s in recordings of their own"
            ),
        ),
        _ => return Ok(time),
    };
    Err(RecordingError::Value { line, what: "the time stamp".to_owned(), got, wanted })
}

pub(super) fn position(
    line: usize,
    joint: Body25,
    position: Point3<f64>,
) -> Result<Point3<f64>, RecordingError> {
    match Body::far_coordinate(&position, &Point3::origin()) {
        None => Ok(position),
        Some(value) => Err(RecordingError::Value {
            line,
            what: format!("a coordinate of {}", keypoint(joint)),
            got: format!("{value} m"),
            wanted: format!(
                "finite positions in metres, within {} m of the origin",
                Body::FARTHEST
            ),
        }),
    }
}

pub(super) fn confidence(
    line: usize,
    of: impl FnOnce() -> String,
    value: f64,
) -> Result<Confidence, RecordingError> {
    Confidence::new(value).map_err(|_| RecordingError::Value {
        line,
        what: format!("the confidence of {}", of()),
        got: value.to_string(),
        wanted: "a probability in [0, 1]".to_owned(),
    })
}

/// Checks that each of `people` has an id of their own, or none.
pub(super) fn ids(line: usize, ids: &[Option<u64>], people: usize) -> Result<(), RecordingError> {
    let mut known: Vec<_> = ids.iter().flatten().collect();
    known.sort_unstable();
    let is_twice = known.windows(2).any(|pair| matches!(pair, [one, other] if one == other));
    if ids.len() == people && !is_twice {
        return Ok(());
    }
    Err(RecordingError::Value {
        line,
        what: "the ids of the people".to_owned(),
        got: Excerpt(&format!("{ids:?}")).to_string(),
        wanted: format!("{people}, of the person and of each other, all different or null"),
    })
}

/// Describes a keypoint in words.
pub(super) fn keypoint(joint: Body25) -> String {
    format!("keypoint {} ({})", joint.index(), joint.name())
}

/// Adds to an error that it is about the keypoints of another person in the frame, counted from 1.
pub(super) fn of_other(error: RecordingError, person: usize) -> RecordingError {
    match error {
        RecordingError::Value { line, what, got, wanted } => {
            let what = format!("{what} of other person {person} in the frame");
            RecordingError::Value { line, what, got, wanted }
        }
        error => error,
    }
}
