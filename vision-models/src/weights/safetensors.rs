//! The safetensors format: the header's length in eight bytes, the header in JSON, then the
//! tensors without gaps. <https://github.com/huggingface/safetensors#format>

use std::{
    collections::{BTreeMap, btree_map::Entry},
    fmt,
    io::{Read, Seek, Write},
};

use serde::{
    Deserialize, Serialize,
    de::{DeserializeSeed, Deserializer, Error as _, MapAccess, SeqAccess, Visitor},
    ser::SerializeMap,
};

use super::budget::Budget;
use super::contents::Contents;
use super::error::{beyond, refused};
use super::input::{Input, reading};
use super::shape::{MAX_AXES, elements};
use crate::error::Error;
use crate::excerpt::Excerpt;
use crate::weights::contents::Format;
use crate::weights::element::ElementType;
use crate::weights::tensor_info::TensorInfo;
use crate::weights::tensors::Tensors;

/// Largest header that is accepted (bytes). The format allows 100 MB.
const MAX_HEADER: u64 = 16 << 20;
/// Largest number of reported metadata keys and of tensors of other types, and of characters of
/// each.
const OTHERS: usize = 64;
/// The key of an entry that is no tensor.
const METADATA: &str = "__metadata__";

/// Returns true if a file that starts with these bytes may have this format.
pub(super) fn is_safetensors(start: &[u8]) -> bool {
    start.get(8) == Some(&b'{')
}

/// A tensor in the header. `data_offsets` count from the end of the header (bytes).
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Record {
    dtype: String,
    #[serde(deserialize_with = "read_shape")]
    shape: Vec<usize>,
    data_offsets: [u64; 2],
}

/// Reads the header of a file of `length` bytes.
pub(super) fn read<R: Read + Seek>(
    source: &mut R,
    length: u64,
    budget: &mut Budget,
) -> Result<Contents, Error> {
    let size = u64::from_le_bytes(Input::open(source, 0, length.min(8), length)?.array("header")?);
    if size > MAX_HEADER {
        return Err(beyond(HEADER_BYTES, size, MAX_HEADER));
    }
    let mut input = Input::open(source, 8, size, length)?;
    // The header, and the text that is being read in it.
    budget.take(usize::try_from(size).unwrap_or(usize::MAX).saturating_mul(2))?;
    let bytes = input.bytes(size, "header")?;
    let mut json = serde_json::Deserializer::from_slice(&bytes);
    let header = HeaderReader(budget)
        .deserialize(&mut json)
        .and_then(|header| json.end().map(|()| header))
        .map_err(|error| problem(Excerpt(&error.to_string()).to_string()))?;

    let start = 8 + size;
    let mut tensors = BTreeMap::new();
    let mut places = Vec::with_capacity(header.records.len());
    let (mut others, mut unread) = (header.metadata, Vec::new());
    for (name, record) in header.records {
        let [begin, end] = record.data_offsets;
        let shown = Excerpt(&name);
        let Some(element) = ElementType::from_name(&record.dtype) else {
            if begin > end {
                return Err(problem(format!("tensor \"{shown}\" is from {begin} to {end}")));
            }
            places.push((begin, end));
            if unread.len() < OTHERS {
                unread.push(name.chars().take(OTHERS).collect::<String>());
            }
            continue;
        };
        let info = TensorInfo::contiguous(element, record.shape, start.saturating_add(begin));
        let bytes = info.as_ref().and_then(|info| info.elements().checked_mul(element.size()));
        let (Some(info), Some(bytes)) = (info, bytes) else {
            return Err(problem(format!("tensor \"{shown}\" has a shape beyond all bounds")));
        };
        if begin.checked_add(bytes as u64) != Some(end) {
            return Err(problem(format!(
                "tensor \"{shown}\" takes {bytes} bytes, but its place is {begin} to {end}"
            )));
        }
        places.push((begin, end));
        tensors.insert(name, info);
    }
    check_places(places, length - start)?;
    if tensors.is_empty() && !unread.is_empty() {
        return Err(problem(format!(
            "no tensor has elements of a known type: the first is \"{}\"",
            Excerpt(unread.first().map_or("", String::as_str))
        )));
    }
    others.extend(unread.iter().cloned());
    let wrappers = Vec::new();
    Ok(Contents { format: Format::Safetensors, tensors, wrappers, others, unread })
}

/// Checks that every byte after the header belongs to exactly one tensor.
fn check_places(mut places: Vec<(u64, u64)>, length: u64) -> Result<(), Error> {
    places.sort_unstable();
    let mut next = 0;
    for (begin, end) in places {
        if begin != next {
            return Err(problem(format!(
                "a tensor starts at byte {begin} of the data, but the one before ends at {next}"
            )));
        }
        next = end;
    }
    if next == length {
        Ok(())
    } else {
        Err(problem(format!("the tensors take {next} bytes, but the file has {length} for them")))
    }
}

/// Writes tensors, all as f32.
pub(super) fn write(writer: &mut impl Write, tensors: &Tensors) -> Result<(), Error> {
    let all = || tensors.names().filter_map(|name| Some((name, tensors.get(name)?)));
    write_header(writer, all().map(|(name, tensor)| (name, ElementType::F32, tensor.shape())))?;
    let mut bytes = Vec::new();
    for (_, tensor) in all() {
        for values in tensor.data().chunks(32 << 10) {
            bytes.clear();
            bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
            writer.write_all(&bytes).map_err(|error| reading(&error))?;
        }
    }
    writer.flush().map_err(|error| reading(&error))
}

/// Writes the header of tensors that will follow in this order. It writes nothing that [`read`]
/// would reject.
pub(super) fn write_header<'a>(
    writer: &mut impl Write,
    tensors: impl Iterator<Item = (&'a str, ElementType, &'a [usize])>,
) -> Result<(), Error> {
    let mut next = 0;
    let records = tensors
        .map(|(name, element, shape)| {
            if name == METADATA {
                return Err(problem(format!("a tensor cannot be named \"{METADATA}\"")));
            }
            if shape.len() > MAX_AXES {
                let (shown, axes) = (Excerpt(name), shape.len());
                return Err(problem(format!(
                    "tensor \"{shown}\" has {axes} axes: give at most {MAX_AXES}"
                )));
            }
            let begin = next;
            next += elements(shape).unwrap_or(0) as u64 * element.size() as u64;
            let dtype = element.name().to_owned();
            Ok((name, Record { dtype, shape: shape.to_vec(), data_offsets: [begin, next] }))
        })
        .collect::<Result<_, Error>>()?;
    let records = HeaderToWrite(records);
    let mut header = serde_json::to_vec(&records).map_err(|error| problem(error.to_string()))?;
    // The format requires spaces up to a multiple of eight.
    header.resize(header.len().next_multiple_of(8), b' ');
    if header.len() as u64 > MAX_HEADER {
        return Err(beyond(HEADER_BYTES, header.len() as u64, MAX_HEADER));
    }
    let mut budget = Budget::of_file(8 + header.len() as u64 + next);
    budget.take(2 * header.len())?;
    for (name, record) in &records.0 {
        take_record(&mut budget, name)?;
        budget.take(2 * record.dtype.len())?;
        budget.take_tensor(name, &record.shape)?;
    }
    writer
        .write_all(&(header.len() as u64).to_le_bytes())
        .and_then(|()| writer.write_all(&header))
        .map_err(|error| reading(&error))
}

const HEADER_BYTES: &str = "bytes of the safetensors header";

fn problem(problem: String) -> Error {
    refused("safetensors header", problem)
}

struct HeaderToWrite<'a>(Vec<(&'a str, Record)>);

impl Serialize for HeaderToWrite<'_> {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len() + 1))?;
        map.serialize_entry(METADATA, &BTreeMap::from([("format", "pt")]))?;
        for (name, record) in &self.0 {
            map.serialize_entry(name, record)?;
        }
        map.end()
    }
}

/// The header: a JSON object, in which each name may occur once.
struct Header {
    records: BTreeMap<String, Record>,
    metadata: Vec<String>,
}

/// Charges the memory of a tensor in the header: its record, and the record with its position.
fn take_record(budget: &mut Budget, name: &str) -> Result<(), Error> {
    let shapes = 3 * MAX_AXES * size_of::<usize>();
    budget.take_entry::<String, Record>(2 * name.len() + shapes)?;
    budget.take_entry::<String, TensorInfo>(size_of::<(u64, u64)>())
}

/// Reads a header within the memory budget of its file.
struct HeaderReader<'a>(&'a mut Budget);

impl<'de> DeserializeSeed<'de> for HeaderReader<'_> {
    type Value = Header;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Header, D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for HeaderReader<'_> {
    type Value = Header;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("an object with a record for each tensor")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Header, A::Error> {
        let mut header = Header { records: BTreeMap::new(), metadata: Vec::new() };
        while let Some(name) = map.next_key::<String>()? {
            if name == METADATA {
                header.metadata = map.next_value::<Metadata>()?.0;
                continue;
            }
            take_record(self.0, &name).map_err(A::Error::custom)?;
            match header.records.entry(name) {
                Entry::Vacant(place) => {
                    let record: Record = map.next_value()?;
                    self.0.take(2 * record.dtype.len()).map_err(A::Error::custom)?;
                    place.insert(record);
                }
                Entry::Occupied(place) => {
                    let name = Excerpt(place.key());
                    return Err(A::Error::custom(format_args!("two tensors are named \"{name}\"")));
                }
            }
        }
        Ok(header)
    }
}

/// The first keys of the metadata, whose values are unused texts.
struct Metadata(Vec<String>);

impl<'de> Deserialize<'de> for Metadata {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(MetadataVisitor)
    }
}

struct MetadataVisitor;

impl<'de> Visitor<'de> for MetadataVisitor {
    type Value = Metadata;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("an object of texts")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Metadata, A::Error> {
        let mut keys = Vec::new();
        while let Some((key, _)) = map.next_entry::<String, String>()? {
            if keys.len() < OTHERS {
                keys.push(key.chars().take(OTHERS).collect());
            }
        }
        Ok(Metadata(keys))
    }
}

/// A list of at most [`MAX_AXES`] lengths.
fn read_shape<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<usize>, D::Error> {
    deserializer.deserialize_seq(ShapeVisitor)
}

struct ShapeVisitor;

impl<'de> Visitor<'de> for ShapeVisitor {
    type Value = Vec<usize>;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "a list of at most {MAX_AXES} lengths")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Vec<usize>, A::Error> {
        let mut shape = Vec::with_capacity(MAX_AXES);
        while let Some(axis) = list.next_element()? {
            if shape.len() == MAX_AXES {
                return Err(A::Error::invalid_length(MAX_AXES + 1, &self));
            }
            shape.push(axis);
        }
        Ok(shape)
    }
}
