//! Extracts a recording from MCAP.

use std::collections::{BTreeMap, BTreeSet};

use super::error::McapError;
use super::records::{Fields, each, opcode};
use super::{PERCEPT, PERCEPTS, RECORDING};
use crate::reader::Reader;

/// The parts of a recording in a file.
#[derive(Default)]
struct Found {
    /// Names of schemas.
    schemas: BTreeMap<u64, String>,
    /// Topic and schema of each channel.
    channels: BTreeMap<u64, (String, u64)>,
    /// Topics with messages.
    topics: BTreeSet<String>,
    metadata: Option<BTreeMap<String, String>>,
    /// The lines of the frames, with the time of the message \[ns\].
    lines: Vec<(u64, Vec<u8>)>,
}

impl Found {
    fn take(&mut self, code: u8, data: &[u8]) -> Result<(), McapError> {
        let mut fields = Fields(data);
        match code {
            opcode::SCHEMA => {
                let id = fields.number::<2>("schema")?;
                self.schemas.insert(id, fields.text("schema")?);
            }
            opcode::CHANNEL => {
                let (id, schema) = (fields.number::<2>("channel")?, fields.number::<2>("channel")?);
                self.channels.insert(id, (fields.text("channel")?, schema));
            }
            opcode::METADATA if fields.text("metadata")? == RECORDING => {
                self.metadata = Some(fields.map("metadata")?);
            }
            opcode::MESSAGE => {
                let channel = fields.number::<2>("message")?;
                let _sequence = fields.number::<4>("message")?;
                let time = fields.number::<8>("message")?;
                let _published = fields.number::<8>("message")?;
                self.message(channel, time, fields.0)?;
            }
            _ => {}
        }
        Ok(())
    }

    fn message(&mut self, channel: u64, time: u64, data: &[u8]) -> Result<(), McapError> {
        let Some((topic, schema)) = self.channels.get(&channel) else {
            return Err(McapError::Channel { channel });
        };
        if !self.topics.contains(topic) {
            self.topics.insert(topic.clone());
        }
        if topic != PERCEPTS {
            return Ok(());
        }
        let schema = self.schemas.get(schema).map_or("", String::as_str);
        if schema != PERCEPT {
            return Err(McapError::Schema { found: format!("{schema:?}") });
        }
        self.lines.push((time, data.to_vec()));
        Ok(())
    }
}

/// Returns the recording in a file as JSON Lines, byte for byte.
///
/// Frames are sorted by the times of their messages, whatever their order in the file. The result
/// is checked by the reader of recordings.
///
/// # Errors
/// [`McapError::Mcap`] if the file is truncated or broken. The others if it has other contents.
pub fn to_json_lines(file: &[u8]) -> Result<Vec<u8>, McapError> {
    let mut found = Found::default();
    each(file, |code, data| found.take(code, data))?;
    let Found { topics, metadata, mut lines, .. } = found;
    let missing = |missing| McapError::NoRecording {
        missing,
        topics: topics.iter().cloned().collect::<Vec<_>>().join(", "),
    };
    let metadata = metadata.ok_or_else(|| missing("the metadata moca.Recording"))?;
    let entry = |name, what| metadata.get(name).ok_or_else(|| missing(what));
    let header = entry("header", "the header in the metadata")?;
    let closing = entry("closing", "the closing line in the metadata")?;
    let expected = entry("frames", "the number of frames in the metadata")?.parse().unwrap_or(0);
    let frames = lines.len() as u64;
    if frames != expected {
        return Err(McapError::Frames { found: frames, expected });
    }
    // Messages of equal times keep their order.
    lines.sort_by_key(|(time, _)| *time);
    let mut text = header.as_bytes().to_vec();
    for (_, line) in &lines {
        text.extend_from_slice(line);
    }
    text.extend_from_slice(closing.as_bytes());
    check(&text)?;
    Ok(text)
}

/// Checks that a complete or partial recording can be read.
fn check(text: &[u8]) -> Result<(), McapError> {
    for percept in Reader::new(text)? {
        match percept {
            Err(error) if !error.is_early_end() => return Err(error.into()),
            _ => {}
        }
    }
    Ok(())
}
