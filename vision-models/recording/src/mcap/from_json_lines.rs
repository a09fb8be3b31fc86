//! Converts a recording to MCAP.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use schemars::JsonSchema;
use vision_models::{Body, Body25, Percept};

use super::error::McapError;
use super::messages::{Colour, Entity, SceneUpdate, Shape, Time};
use super::writer::McapWriter;
use super::{PERCEPT, PERCEPTS, RECORDING};
use crate::error::RecordingError;
use crate::reader::Reader;

/// Time for which a body that is not seen again is displayed \[s\].
const LIFETIME: f64 = 0.5;
/// Diameter of a displayed joint \[m\].
const DIAMETER: f64 = 0.06;

/// A camera frame of a recording, as the book's page "Recordings" describes it.
#[derive(JsonSchema)]
#[expect(dead_code, reason = "it describes the lines, which are written as they are")]
struct PerceptLine {
    /// Time at which the camera took the frame \[s\].
    time: f64,
    /// x, y, z \[m\] and confidence of BODY_25's joints. Null for joints that were not seen.
    keypoints: Option<Vec<Option<[f64; 4]>>>,
    /// The keypoints of each other person in the frame.
    others: Option<Vec<Vec<Option<[f64; 4]>>>>,
    /// Ids of the person, then of each other person. Null for those who were not tracked.
    ids: Option<Vec<Option<u64>>>,
    /// The person's action.
    action: Option<serde_json::Value>,
    /// The surface in front of the on-board camera.
    surface: Option<serde_json::Value>,
}

/// Converts a complete or partial recording in JSON Lines to an MCAP file.
/// [`to_json_lines`](super::to_json_lines) restores every byte. The file also shows the body as a
/// scene.
///
/// # Errors
/// [`McapError::Recording`] if the text is not a recording.
pub fn from_json_lines(text: &[u8]) -> Result<Vec<u8>, McapError> {
    McapWriter::with_recording(text)?.finish()
}

impl McapWriter {
    /// Creates a file with a complete or partial recording in JSON Lines, and the body as a scene.
    ///
    /// # Errors
    /// [`McapError::Recording`] if the text is not a recording.
    pub fn with_recording(text: &[u8]) -> Result<Self, McapError> {
        let mut file = Self::new()?;
        write_recording(&mut file, text)?;
        Ok(file)
    }
}

/// Writes a recording into a file.
fn write_recording(file: &mut McapWriter, text: &[u8]) -> Result<(), McapError> {
    let seen = frames(text)?;
    let lines: Vec<&[u8]> = text.split_inclusive(|byte| *byte == b'\n').collect();
    let Some((header, lines)) = lines.split_first() else { return Ok(()) };
    let frames = lines.len().min(seen.len());
    let (frames, closing) = lines.split_at(frames);
    let as_text = |bytes: &[u8]| String::from_utf8(bytes.to_vec());
    let entries = [
        ("header", as_text(header)?),
        ("closing", as_text(&closing.concat())?),
        ("frames", frames.len().to_string()),
    ];
    let entries = entries.map(|(name, text)| (name.to_owned(), text));
    file.metadata(RECORDING, BTreeMap::from(entries))?;
    let channel = file.channel_of::<PerceptLine>(PERCEPTS, PERCEPT)?;
    let scene = file.channel::<SceneUpdate>("/person")?;
    for (line, (percept, others)) in frames.iter().zip(&seen) {
        let time = percept.time;
        file.write_bytes(channel, time, line)?;
        let person = percept.body.iter().map(|body| drawn(time, "person", body));
        let others = others.iter().zip(1..).map(|(body, number)| {
            let name = match body.id() {
                Some(id) => format!("person {}", id.number()),
                None => format!("other {number}"),
            };
            drawn(time, &name, body)
        });
        let everybody: Vec<Entity> = person.chain(others).collect();
        if !everybody.is_empty() {
            file.write(scene, time, &SceneUpdate::from(everybody))?;
        }
    }
    Ok(())
}

/// Returns the frames of a recording with the other people, up to its end or the first early end.
fn frames(text: &[u8]) -> Result<Vec<(Percept, Vec<Body>)>, RecordingError> {
    let mut reader = Reader::new(text)?;
    let mut frames = Vec::new();
    while let Some(percept) = reader.next() {
        match percept {
            Ok(percept) => frames.push((percept, reader.others().to_vec())),
            Err(error) if error.is_early_end() => break,
            Err(error) => return Err(error),
        }
    }
    Ok(frames)
}

/// Returns a body as spheres.
fn drawn(time: f64, name: &str, body: &Body) -> Entity {
    let mut entity = Entity::new(name, Time::new(time), LIFETIME);
    let seen = Body25::ALL.into_iter().filter_map(|joint| body.get(joint));
    let size = Vector3::repeat(DIAMETER);
    let sphere = |point: Vector3<f64>| Shape::new(point.map(millimetres), size, Colour::PERSON);
    entity.spheres = seen.map(|keypoint| sphere(keypoint.position.coords)).collect();
    entity
}

/// Rounds a coordinate to millimetres, which is enough for display.
fn millimetres(coordinate: f64) -> f64 {
    (coordinate * 1e3).round() / 1e3
}
