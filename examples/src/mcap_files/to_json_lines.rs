//! A recording out of MCAP.

use std::collections::{BTreeMap, BTreeSet};

use mcap::Message;
use mcap::read::LinearReader;
use mcap::records::Record;
use mcap::sans_io::{LinearReaderOptions, MessageReadEvent, MessageReader};

use super::error::McapFileError;
use super::{PERCEPT, PERCEPTS, RECORDING};

/// The most that a chunk, or a record in it, may hold \[bytes\]; writers begin a new chunk after one or a few million.
const LARGEST: u32 = 256 << 20;

/// The messages of a file, in their order.
struct Messages<'a> {
    reader: MessageReader,
    rest: &'a [u8],
}

impl<'a> Messages<'a> {
    fn new(file: &'a [u8]) -> Self {
        // Without a limit the library takes as much memory as a record claims.
        let options = LinearReaderOptions::default()
            .with_record_length_limit(LARGEST as usize)
            .with_validate_chunk_crcs(true);
        Self { reader: MessageReader::new_with_options(options), rest: file }
    }
}

impl Iterator for Messages<'_> {
    type Item = Result<Message<'static>, mcap::McapError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            match self.reader.next_event()? {
                Ok(MessageReadEvent::Message(message)) => return Some(Ok(message)),
                Ok(MessageReadEvent::ReadRequest(wanted)) => {
                    let (now, later) = self.rest.split_at(wanted.min(self.rest.len()));
                    self.reader.insert(now.len()).copy_from_slice(now);
                    self.reader.notify_read(now.len());
                    self.rest = later;
                }
                Err(error) => return Some(Err(error)),
            }
        }
    }
}

/// The recording in JSON Lines that a file holds, to the byte as it was.
///
/// # Errors
/// [`McapFileError::Mcap`] for a file that is cut off or broken, the others for one of something else.
pub fn to_json_lines(file: &[u8]) -> Result<Vec<u8>, McapFileError> {
    let mut metadata = None;
    for record in LinearReader::new(file)? {
        match record? {
            Record::Metadata(found) if found.name == RECORDING => metadata = Some(found.metadata),
            // The library takes as much memory as a chunk claims.
            Record::Chunk { header, .. } if header.uncompressed_size > LARGEST.into() => {
                return Err(McapFileError::Chunk { claimed: header.uncompressed_size });
            }
            _ => {}
        }
    }
    let (mut topics, mut lines, mut frames) = (BTreeSet::new(), Vec::new(), 0_u64);
    for message in Messages::new(file) {
        let message = message?;
        topics.insert(message.channel.topic.clone());
        if message.channel.topic != PERCEPTS {
            continue;
        }
        let schema = message.channel.schema.as_ref().map_or("", |schema| schema.name.as_str());
        if schema != PERCEPT {
            return Err(McapFileError::Schema { found: format!("\"{schema}\"") });
        }
        lines.extend_from_slice(&message.data);
        frames += 1;
    }
    let missing = |missing| McapFileError::NoRecording {
        missing,
        topics: topics.iter().cloned().collect::<Vec<_>>().join(", "),
    };
    let metadata: BTreeMap<String, String> =
        metadata.ok_or_else(|| missing("the metadata moca.Recording"))?;
    let entry = |name, what| metadata.get(name).ok_or_else(|| missing(what));
    let header = entry("header", "the header in the metadata")?;
    let closing = entry("closing", "the closing line in the metadata")?;
    let expected = entry("frames", "the number of frames in the metadata")?.parse().unwrap_or(0);
    if frames != expected {
        return Err(McapFileError::Frames { found: frames, expected });
    }
    Ok([header.as_bytes(), &lines, closing.as_bytes()].concat())
}
