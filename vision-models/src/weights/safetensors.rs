//! The safetensors format: the header's length in eight bytes, the header in JSON, then the
//! tensors without gaps. <https://github.com/huggingface/safetensors#format>

use std::{
    collections::{BTreeMap, btree_map::Entry},
    fmt,
    io::{Read, Seek, Write},
};

use serde::{
    Deserialize, Serialize,
    de::{Deserializer, MapAccess, Visitor},
    ser::SerializeMap,
};

use super::{
    CheckpointError, ElementType, Format, TensorInfo,
    checkpoint::Contents,
    input::{Input, reading},
};
use crate::{Error, Tensors, error::Excerpt};

/// The largest header that is accepted (bytes); the format allows 100 MB.
const MAX_HEADER: u64 = 16 << 20;
/// The key for what is no tensor.
const METADATA: &str = "__metadata__";

/// Whether a file that starts with these bytes may be of this format.
pub(super) fn is_safetensors(start: &[u8]) -> bool {
    start.get(8) == Some(&b'{')
}

/// A tensor in the header. `data_offsets` count from the end of the header (bytes).
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Record {
    dtype: String,
    shape: Vec<usize>,
    data_offsets: [u64; 2],
}

/// Reads the header of a file of `length` bytes.
pub(super) fn read<R: Read + Seek>(source: &mut R, length: u64) -> Result<Contents, Error> {
    let size = u64::from_le_bytes(Input::open(source, 0, length.min(8), length)?.array("header")?);
    if size > MAX_HEADER {
        let what = "bytes of the safetensors header";
        return Err(CheckpointError::Limit { what, value: size, limit: MAX_HEADER }.into());
    }
    let bytes = Input::open(source, 8, size, length)?.bytes(size, "header")?;
    let header: Header = serde_json::from_slice(&bytes)
        .map_err(|error| problem(Excerpt(&error.to_string()).to_string()))?;

    let start = 8 + size;
    let mut tensors = BTreeMap::new();
    let mut places = Vec::with_capacity(header.records.len());
    for (name, record) in header.records {
        let [begin, end] = record.data_offsets;
        let shown = Excerpt(&name);
        let element = ElementType::from_name(&record.dtype).ok_or_else(|| {
            let kind = Excerpt(&record.dtype);
            problem(format!("tensor \"{shown}\" has elements of the unknown type {kind}"))
        })?;
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
    let (wrappers, others) = (Vec::new(), header.metadata);
    Ok(Contents { format: Format::Safetensors, tensors, wrappers, others })
}

/// Every byte after the header belongs to exactly one tensor.
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

/// Writes the header of tensors that will follow in this order.
pub(super) fn write_header<'a>(
    writer: &mut impl Write,
    tensors: impl Iterator<Item = (&'a str, ElementType, &'a [usize])>,
) -> Result<(), Error> {
    let mut next = 0;
    let records = tensors
        .map(|(name, element, shape)| {
            let begin = next;
            next += shape.iter().product::<usize>() as u64 * element.size() as u64;
            let dtype = element.name().to_owned();
            (name, Record { dtype, shape: shape.to_vec(), data_offsets: [begin, next] })
        })
        .collect();
    let mut header =
        serde_json::to_vec(&HeaderToWrite(records)).map_err(|error| problem(error.to_string()))?;
    // The format asks for spaces up to a multiple of eight.
    header.resize(header.len().next_multiple_of(8), b' ');
    writer
        .write_all(&(header.len() as u64).to_le_bytes())
        .and_then(|()| writer.write_all(&header))
        .map_err(|error| reading(&error))
}

fn problem(problem: String) -> Error {
    CheckpointError::Header { problem }.into()
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

impl<'de> Deserialize<'de> for Header {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(HeaderVisitor)
    }
}

struct HeaderVisitor;

impl<'de> Visitor<'de> for HeaderVisitor {
    type Value = Header;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("an object with a record for each tensor")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Header, A::Error> {
        use serde::de::Error as _;
        let mut header = Header { records: BTreeMap::new(), metadata: Vec::new() };
        while let Some(name) = map.next_key::<String>()? {
            if name == METADATA {
                let metadata: BTreeMap<String, String> = map.next_value()?;
                header.metadata = metadata.into_keys().take(64).collect();
                continue;
            }
            match header.records.entry(name) {
                Entry::Vacant(place) => {
                    place.insert(map.next_value()?);
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
