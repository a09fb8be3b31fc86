//! The directory of a zip archive, as far as `torch.save` uses the format. Entries are not
//! compressed, so each is a range of bytes of the file.
//!
//! `rawzip` reads it. PKWARE, APPNOTE.TXT, 4.3.7, describes the header before an entry's bytes.

use std::{
    collections::BTreeMap,
    io::{BufReader, Read, Seek},
};

use rawzip::{CompressionMethod, ErrorKind, MAX_CENTRAL_DIRECTORY_RECORD_SIZE, ZipArchive};

use super::{
    budget::Budget,
    error::{beyond, refused, truncated},
    input::{Input, reading},
};
use crate::error::Error;
use crate::excerpt::Excerpt;

/// An entry's bytes within the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Entry {
    header: u64,
    pub(super) length: u64,
    /// CRC-32, or `None` if the writer left it out.
    pub(super) checksum: Option<u32>,
}

/// The entries by name.
#[derive(Debug)]
pub(super) struct Archive {
    entries: BTreeMap<String, Entry>,
    length: u64,
}

impl Archive {
    /// Reads the directory of a file of `length` bytes.
    pub(super) fn read<R: Read + Seek>(
        source: &mut R,
        length: u64,
        budget: &mut Budget,
    ) -> Result<Self, Error> {
        let mut buffer = vec![0; MAX_CENTRAL_DIRECTORY_RECORD_SIZE];
        let archive = ZipArchive::from_seekable(source, &mut buffer).map_err(|e| of_zip(&e))?;
        let mut records = archive.entries(&mut buffer);
        let mut entries = BTreeMap::new();
        while let Some(record) = records.next_entry().map_err(|error| of_zip(&error))? {
            let name = String::from_utf8_lossy(record.file_path().as_bytes()).into_owned();
            budget.take_entry::<String, Entry>(2 * name.len())?;
            if record.compression_method() != CompressionMethod::STORE {
                return Err(problem(&name, "it is compressed, which torch.save never does"));
            }
            if record.flags().is_encrypted() {
                return Err(problem(&name, "it is encrypted"));
            }
            let leads_out = name.split('/').any(|part| part == "..");
            if leads_out || name.starts_with('/') || name.contains('\\') {
                return Err(problem(&name, "its name leads out of the archive"));
            }
            let length = record.uncompressed_size_hint();
            if record.compressed_size_hint() != length {
                return Err(problem(&name, "it is uncompressed and yet has two sizes"));
            }
            let checksum = Some(record.crc32()).filter(|&checksum| checksum != 0);
            let entry = Entry { header: record.local_header_offset(), length, checksum };
            if entries.contains_key(&name) {
                return Err(problem(&name, "it is there twice"));
            }
            entries.insert(name, entry);
        }
        if archive.entries_hint() != entries.len() as u64 {
            return Err(problem("", "its directory has another length than it says"));
        }
        Ok(Self { entries, length })
    }

    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.entries.keys().map(String::as_str)
    }

    pub(super) fn get(&self, name: &str) -> Option<Entry> {
        self.entries.get(name).copied()
    }

    /// Returns the bytes of an entry, if it exists.
    pub(super) fn open<'a, R: Read + Seek>(
        &self,
        name: &str,
        limit: u64,
        source: &'a mut R,
    ) -> Result<Option<Input<BufReader<&'a mut R>>>, Error> {
        let Some(entry) = self.get(name) else { return Ok(None) };
        if entry.length > limit {
            return Err(beyond("bytes of a zip entry", entry.length, limit));
        }
        let position = self.position(name, entry, source)?;
        Input::open(source, position, entry.length, self.length).map(Some)
    }

    /// Returns the position of an entry's bytes in the file. A second header precedes them.
    pub(super) fn position<R: Read + Seek>(
        &self,
        name: &str,
        entry: Entry,
        source: &mut R,
    ) -> Result<u64, Error> {
        const HEADER: u64 = 30;
        let mut input = Input::open(source, entry.header, HEADER, self.length)?;
        if input.array("zip entry")? != *b"PK\x03\x04" {
            return Err(problem(name, "there is no header where the directory says"));
        }
        input.skip(22, "zip entry")?;
        let skip = u64::from(u16::from_le_bytes(input.array("zip entry")?))
            + u64::from(u16::from_le_bytes(input.array("zip entry")?));
        let position = input.position() + skip;
        match self.length.checked_sub(position) {
            Some(available) if available >= entry.length => Ok(position),
            rest => Err(truncated("zip entry", position, entry.length, rest.unwrap_or(0))),
        }
    }
}

fn of_zip(error: &rawzip::Error) -> Error {
    match error.kind() {
        ErrorKind::IO(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => {
            problem("", "its directory reaches beyond its end: the file is cut off or corrupted")
        }
        ErrorKind::IO(error) => reading(error),
        ErrorKind::MissingEndOfCentralDirectory => {
            problem("", "its directory is missing: the file is cut off")
        }
        _ => problem("", "its directory is corrupted"),
    }
}

pub(super) fn problem(entry: &str, problem: &'static str) -> Error {
    refused(format_args!("zip archive, entry \"{}\"", Excerpt(entry)), problem)
}
