//! The directory of a zip archive, as far as `torch.save` uses the format: entries are stored
//! uncompressed, so that each is a range of bytes of the file.
//!
//! PKWARE, APPNOTE.TXT, 4.3 and 4.5.3 (zip64).

use std::{
    collections::BTreeMap,
    io::{BufRead, BufReader, Read, Seek},
};

use super::{CheckpointError, budget::Budget, input::Input};
use crate::Error;

/// The size of the directory's end, without its comment, and of the longest comment.
const END: u64 = 22;
const LONGEST_COMMENT: u64 = 0xffff;
/// More bytes of directory than any checkpoint has: enough for 400,000 entries.
const MAX_DIRECTORY: u64 = 64 << 20;

/// An entry's bytes within the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Entry {
    header: u64,
    pub(super) length: u64,
    /// CRC-32; `None` if the writer left it out.
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
        let (start, size, count) = locate_directory(source, length)?;
        if size > MAX_DIRECTORY {
            let what = "bytes of the zip directory";
            return Err(CheckpointError::Limit { what, value: size, limit: MAX_DIRECTORY }.into());
        }
        let mut input = Input::open(source, start, size, length)?;
        let mut entries = BTreeMap::new();
        for _ in 0..count {
            let (name, entry) = read_entry(&mut input)?;
            budget.take_entry::<String, Entry>(2 * name.len())?;
            if entries.contains_key(&name) {
                return Err(problem(&name, "it is there twice"));
            }
            entries.insert(name, entry);
        }
        Ok(Self { entries, length })
    }

    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.entries.keys().map(String::as_str)
    }

    pub(super) fn get(&self, name: &str) -> Option<Entry> {
        self.entries.get(name).copied()
    }

    /// The bytes of an entry, if it is there.
    pub(super) fn open<'a, R: Read + Seek>(
        &self,
        name: &str,
        limit: u64,
        source: &'a mut R,
    ) -> Result<Option<Input<BufReader<&'a mut R>>>, Error> {
        let Some(entry) = self.get(name) else { return Ok(None) };
        if entry.length > limit {
            let what = "bytes of a zip entry";
            return Err(CheckpointError::Limit { what, value: entry.length, limit }.into());
        }
        let position = self.position(name, entry, source)?;
        Input::open(source, position, entry.length, self.length).map(Some)
    }

    /// Where the bytes of an entry are in the file: the entry has a second header before them.
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
            rest => {
                let (what, needed, available) = ("zip entry", entry.length, rest.unwrap_or(0));
                Err(CheckpointError::Truncated { what, position, needed, available }.into())
            }
        }
    }
}

/// The directory's position, size and number of entries, from the end of the file.
fn locate_directory<R: Read + Seek>(source: &mut R, length: u64) -> Result<(u64, u64, u64), Error> {
    let size = length.min(END + LONGEST_COMMENT);
    let tail =
        Input::open(source, length - size, size, length)?.bytes(size, "end of the archive")?;
    let end = tail
        .windows(4)
        .rposition(|window| window == b"PK\x05\x06")
        .filter(|end| tail.len() - end >= 22)
        .ok_or_else(|| problem("", "its directory is missing: the file is cut off"))?;
    let end = length - size + end as u64;

    let mut input = Input::open(source, end + 4, END - 4, length)?;
    input.skip(6, "end of the archive")?;
    let count = u16::from_le_bytes(input.array("end of the archive")?);
    let size = u32::from_le_bytes(input.array("end of the archive")?);
    let start = u32::from_le_bytes(input.array("end of the archive")?);
    if count != u16::MAX && size != u32::MAX && start != u32::MAX {
        return Ok((u64::from(start), u64::from(size), u64::from(count)));
    }

    // Too large for those fields: another end stands before this one.
    let Some(locator) = end.checked_sub(20) else {
        return Err(problem("", "its zip64 directory is missing"));
    };
    let mut input = Input::open(source, locator, 20, length)?;
    if input.array("zip64 locator")? != *b"PK\x06\x07" {
        return Err(problem("", "its zip64 directory is missing"));
    }
    input.skip(4, "zip64 locator")?;
    let position = u64::from_le_bytes(input.array("zip64 locator")?);
    let mut input = Input::open(source, position, 56, length)?;
    if input.array("zip64 end")? != *b"PK\x06\x06" {
        return Err(problem("", "its zip64 directory is missing"));
    }
    input.skip(28, "zip64 end")?;
    let count = u64::from_le_bytes(input.array("zip64 end")?);
    let size = u64::from_le_bytes(input.array("zip64 end")?);
    let start = u64::from_le_bytes(input.array("zip64 end")?);
    Ok((start, size, count))
}

fn read_entry<R: BufRead>(input: &mut Input<R>) -> Result<(String, Entry), Error> {
    const WHAT: &str = "zip directory";
    if input.array(WHAT)? != *b"PK\x01\x02" {
        return Err(problem("", "its directory is corrupted"));
    }
    input.skip(4, WHAT)?;
    let flags = u16::from_le_bytes(input.array(WHAT)?);
    let method = u16::from_le_bytes(input.array(WHAT)?);
    input.skip(4, WHAT)?;
    let checksum = u32::from_le_bytes(input.array(WHAT)?);
    let stored = u32::from_le_bytes(input.array(WHAT)?);
    let length = u32::from_le_bytes(input.array(WHAT)?);
    let name_length = u16::from_le_bytes(input.array(WHAT)?);
    let extra_length = u16::from_le_bytes(input.array(WHAT)?);
    let comment_length = u16::from_le_bytes(input.array(WHAT)?);
    input.skip(8, WHAT)?;
    let header = u32::from_le_bytes(input.array(WHAT)?);
    let name = String::from_utf8_lossy(&input.bytes(name_length.into(), WHAT)?).into_owned();
    let extra = input.bytes(extra_length.into(), WHAT)?;
    input.skip(comment_length.into(), WHAT)?;

    if method != 0 {
        return Err(problem(&name, "it is compressed, which torch.save never does"));
    }
    if flags & 1 != 0 {
        return Err(problem(&name, "it is encrypted"));
    }
    if name.starts_with('/') || name.contains('\\') || name.split('/').any(|part| part == "..") {
        return Err(problem(&name, "its name leads out of the archive"));
    }
    // Each field that is too large for its place is in the zip64 field, in this order.
    let mut large = zip64_values(&extra);
    let mut full = |value: u32| match value {
        u32::MAX => large.next().ok_or_else(|| problem(&name, "its size is missing")),
        value => Ok(u64::from(value)),
    };
    let (length, stored, header) = (full(length)?, full(stored)?, full(header)?);
    if stored != length {
        return Err(problem(&name, "it is uncompressed and yet has two sizes"));
    }
    Ok((name, Entry { header, length, checksum: (checksum != 0).then_some(checksum) }))
}

/// The numbers in the extra field of zip64.
fn zip64_values(mut extra: &[u8]) -> impl Iterator<Item = u64> {
    const ZIP64: u16 = 1;
    let mut values: &[u8] = &[];
    while let Some((&[id_low, id_high, low, high], rest)) = extra.split_first_chunk() {
        let size = usize::from(u16::from_le_bytes([low, high])).min(rest.len());
        let (field, rest) = rest.split_at(size);
        if u16::from_le_bytes([id_low, id_high]) == ZIP64 {
            values = field;
            break;
        }
        extra = rest;
    }
    values.as_chunks().0.iter().map(|&bytes| u64::from_le_bytes(bytes))
}

fn problem(entry: &str, problem: &'static str) -> Error {
    CheckpointError::Archive { entry: entry.into(), problem }.into()
}
