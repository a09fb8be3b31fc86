//! A file that is being written, with its channels.

use std::collections::BTreeMap;
use std::io::Cursor;

use mcap::records::{MessageHeader, Metadata};
use mcap::{WriteOptions, Writer};
use schemars::JsonSchema;
use schemars::generate::SchemaSettings;

use super::error::McapFileError;
use super::messages::{Message, nanoseconds};

/// A file in memory.
pub(super) struct Sink {
    writer: Writer<Cursor<Vec<u8>>>,
    sequence: u32,
}

/// Where messages of one kind go.
#[derive(Clone, Copy, Debug)]
pub(super) struct Channel(u16);

impl Sink {
    pub(super) fn new() -> Result<Self, McapFileError> {
        let options = WriteOptions::new().library(concat!("examples ", env!("CARGO_PKG_VERSION")));
        Ok(Self { writer: options.create(Cursor::new(Vec::new()))?, sequence: 0 })
    }

    /// A channel for messages of this type.
    pub(super) fn channel<M: Message>(&mut self, topic: &str) -> Result<Channel, McapFileError> {
        self.channel_of::<M>(topic, M::SCHEMA)
    }

    /// A channel for JSON that is described by a type.
    pub(super) fn channel_of<T: JsonSchema>(
        &mut self,
        topic: &str,
        schema: &str,
    ) -> Result<Channel, McapFileError> {
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
    ) -> Result<(), McapFileError> {
        Ok(self.writer.write_metadata(&Metadata { name: name.to_owned(), metadata: entries })?)
    }

    /// Writes a message of `time` \[s\].
    pub(super) fn write<M: Message>(
        &mut self,
        channel: Channel,
        time: f64,
        message: &M,
    ) -> Result<(), McapFileError> {
        self.write_bytes(channel, time, &serde_json::to_vec(message)?)
    }

    pub(super) fn write_bytes(
        &mut self,
        Channel(channel_id): Channel,
        time: f64,
        bytes: &[u8],
    ) -> Result<(), McapFileError> {
        let (sequence, log_time) = (self.sequence, nanoseconds(time));
        self.sequence = self.sequence.wrapping_add(1);
        let header = MessageHeader { channel_id, sequence, log_time, publish_time: log_time };
        Ok(self.writer.write_to_known_channel(&header, bytes)?)
    }

    /// The whole file.
    pub(super) fn finish(mut self) -> Result<Vec<u8>, McapFileError> {
        self.writer.finish()?;
        Ok(self.writer.into_inner().into_inner())
    }
}
