//! Writes an MCAP file with several channels.

use std::collections::BTreeMap;
use std::io::Cursor;

use mcap::records::{MessageHeader, Metadata};
use mcap::{WriteOptions, Writer};
use schemars::JsonSchema;
use schemars::generate::SchemaSettings;

use super::error::McapError;
use super::messages::{Message, nanoseconds};

/// A file in memory with a recording and further messages.
pub struct McapWriter {
    writer: Writer<Cursor<Vec<u8>>>,
    sequence: u32,
}

/// A channel for messages of one type.
#[derive(Clone, Copy, Debug)]
pub struct Channel(u16);

impl std::fmt::Debug for McapWriter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("McapWriter").field("sequence", &self.sequence).finish_non_exhaustive()
    }
}

impl McapWriter {
    /// Creates a file without messages.
    ///
    /// # Errors
    /// None in memory.
    pub(super) fn new() -> Result<Self, McapError> {
        let library = concat!(env!("CARGO_PKG_NAME"), " ", env!("CARGO_PKG_VERSION"));
        let writer = WriteOptions::new().library(library).create(Cursor::new(Vec::new()))?;
        Ok(Self { writer, sequence: 0 })
    }

    /// Adds a channel for messages of this type.
    ///
    /// # Errors
    /// None in memory.
    pub fn channel<M: Message>(&mut self, topic: &str) -> Result<Channel, McapError> {
        self.channel_of::<M>(topic, M::SCHEMA)
    }

    /// Adds a channel for JSON whose schema is that of a type.
    pub(super) fn channel_of<T: JsonSchema>(
        &mut self,
        topic: &str,
        schema: &str,
    ) -> Result<Channel, McapError> {
        let mut settings = SchemaSettings::draft07();
        settings.inline_subschemas = true;
        let described = serde_json::to_vec(&settings.into_generator().into_root_schema_for::<T>())?;
        let schema = self.writer.add_schema(schema, "jsonschema", &described)?;
        Ok(Channel(self.writer.add_channel(schema, topic, "json", &BTreeMap::new())?))
    }

    pub(super) fn metadata(
        &mut self,
        name: &str,
        entries: BTreeMap<String, String>,
    ) -> Result<(), McapError> {
        Ok(self.writer.write_metadata(&Metadata { name: name.to_owned(), metadata: entries })?)
    }

    /// Writes a message with this `time` \[s\].
    ///
    /// # Errors
    /// [`McapError::Json`] if the message cannot be written as JSON.
    pub fn write<M: Message>(
        &mut self,
        channel: Channel,
        time: f64,
        message: &M,
    ) -> Result<(), McapError> {
        self.write_bytes(channel, time, &serde_json::to_vec(message)?)
    }

    pub(super) fn write_bytes(
        &mut self,
        Channel(channel_id): Channel,
        time: f64,
        bytes: &[u8],
    ) -> Result<(), McapError> {
        let (sequence, log_time) = (self.sequence, nanoseconds(time));
        self.sequence = self.sequence.wrapping_add(1);
        let header = MessageHeader { channel_id, sequence, log_time, publish_time: log_time };
        Ok(self.writer.write_to_known_channel(&header, bytes)?)
    }

    /// Ends the file and returns all of it.
    ///
    /// # Errors
    /// None in memory.
    pub fn finish(mut self) -> Result<Vec<u8>, McapError> {
        self.writer.finish()?;
        Ok(self.writer.into_inner().into_inner())
    }
}
