//! The records of an MCAP file, and those from which a recording is read.
//!
//! <https://mcap.dev/spec>. Lengths within a record are checked against the record before memory is
//! allocated.

use std::collections::BTreeMap;

use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::error::McapError;

/// Largest size of a chunk or of a record in it \[bytes\]. Writers begin a new chunk after one or a
/// few million bytes.
const LARGEST: u32 = 256 << 20;

/// Codes of the records.
pub(super) mod opcode {
    pub(crate) const SCHEMA: u8 = 0x03;
    pub(crate) const CHANNEL: u8 = 0x04;
    pub(crate) const MESSAGE: u8 = 0x05;
    pub(crate) const CHUNK: u8 = 0x06;
    pub(crate) const METADATA: u8 = 0x0c;
}

/// Passes the records of a file to `take` in order, with those within chunks in place of the
/// chunks. A chunk that is too large, or has an unsupported compression, is an error before memory
/// is allocated for it.
pub(super) fn each(
    file: &[u8],
    mut take: impl FnMut(u8, &[u8]) -> Result<(), McapError>,
) -> Result<(), McapError> {
    pass(file, true, |code, data| if code == opcode::CHUNK { check_chunk(data) } else { Ok(()) })?;
    pass(file, false, &mut take)
}

fn pass(
    file: &[u8],
    whole_chunks: bool,
    mut take: impl FnMut(u8, &[u8]) -> Result<(), McapError>,
) -> Result<(), McapError> {
    let limit = if whole_chunks { file.len() } else { LARGEST as usize };
    // If there is no limit, the library allocates as much memory as a record claims.
    let options = LinearReaderOptions::default()
        .with_record_length_limit(limit)
        .with_emit_chunks(whole_chunks)
        .with_validate_chunk_crcs(true);
    let mut reader = LinearReader::new_with_options(options);
    let mut rest = file;
    while let Some(event) = reader.next_event() {
        match event? {
            LinearReadEvent::ReadRequest(wanted) => {
                let (now, later) = rest.split_at(wanted.min(rest.len()));
                reader.insert(now.len()).copy_from_slice(now);
                reader.notify_read(now.len());
                rest = later;
            }
            LinearReadEvent::Record { opcode, data } => take(opcode, data)?,
        }
    }
    Ok(())
}

fn check_chunk(data: &[u8]) -> Result<(), McapError> {
    let mut fields = Fields(data);
    // The first and the last time.
    let _ = (fields.number::<8>("chunk")?, fields.number::<8>("chunk")?);
    let claimed = fields.number::<8>("chunk")?;
    let _checksum = fields.number::<4>("chunk")?;
    let compression = fields.text("chunk")?;
    if claimed > LARGEST.into() {
        return Err(McapError::Chunk { claimed });
    }
    if !matches!(&*compression, "" | "zstd") {
        return Err(McapError::Compression { found: compression });
    }
    Ok(())
}

/// The remaining bytes of a record.
pub(super) struct Fields<'a>(pub(super) &'a [u8]);

impl<'a> Fields<'a> {
    pub(super) fn bytes(
        &mut self,
        count: usize,
        what: &'static str,
    ) -> Result<&'a [u8], McapError> {
        let left = self.0.len();
        let split = self.0.split_at_checked(count);
        let (bytes, rest) = split.ok_or(McapError::Record { what, needed: count, left })?;
        self.0 = rest;
        Ok(bytes)
    }

    /// Reads a little-endian number of this size.
    pub(super) fn number<const SIZE: usize>(
        &mut self,
        what: &'static str,
    ) -> Result<u64, McapError> {
        let bytes = self.bytes(SIZE, what)?;
        Ok(bytes.iter().rev().fold(0, |number, byte| number << 8 | u64::from(*byte)))
    }

    /// Reads a text preceded by its length.
    pub(super) fn text(&mut self, what: &'static str) -> Result<String, McapError> {
        let length = self.number::<4>(what)?;
        let bytes = self.bytes(usize::try_from(length).unwrap_or(usize::MAX), what)?;
        Ok(String::from_utf8(bytes.to_vec())?)
    }

    /// Reads pairs of texts preceded by their length.
    pub(super) fn map(
        &mut self,
        what: &'static str,
    ) -> Result<BTreeMap<String, String>, McapError> {
        let length = self.number::<4>(what)?;
        let mut fields = Fields(self.bytes(usize::try_from(length).unwrap_or(usize::MAX), what)?);
        let mut map = BTreeMap::new();
        while !fields.0.is_empty() {
            map.insert(fields.text(what)?, fields.text(what)?);
        }
        Ok(map)
    }
}
