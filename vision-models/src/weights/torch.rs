//! The two file formats of `torch.save`.

use std::{
    collections::BTreeMap,
    io::{BufRead, BufReader, Read, Seek, SeekFrom},
};

use super::budget::Budget;
use super::contents::Contents;
use super::error::{big_endian, in_pickle, of_tensor, truncated};
use super::input::{Input, reading};
use super::pickle::{Pickle, Storage, Value, View};
use super::state_dict::StateDict;
use super::tensor_info::Region;
use super::zip::Archive;
use super::{error, pickle, zip};
use crate::error::Error;
use crate::weights::contents::Format;
use crate::weights::tensor_info::TensorInfo;

/// Largest pickle (bytes). It does not contain the weights, so no checkpoint has a larger one.
const MAX_PICKLE: u64 = 64 << 20;
/// The magic number 0x1950a86a20f9469cfc6c at the start of the older format, as a pickle: protocol
/// 2, an integer of ten bytes, end.
const MAGIC: &[u8] = b"\x80\x02\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19.";
const STREAM_VERSION: i64 = 1001;

/// Returns true if a file that starts with these bytes has the older format.
pub(super) fn is_stream(start: &[u8]) -> bool {
    start.starts_with(MAGIC)
}

/// Reads the zip format: `NAME/data.pkl` has the pickle, `NAME/data/KEY` each storage.
pub(super) fn read_archive<R: Read + Seek>(
    source: &mut R,
    length: u64,
    budget: &mut Budget,
) -> Result<Contents, Error> {
    let archive = Archive::read(source, length, budget)?;
    let root = archive
        .names()
        .find_map(|name| name.strip_suffix("data.pkl").filter(|root| is_folder(root)))
        .map(str::to_owned)
        .ok_or_else(|| {
            zip::problem("data.pkl", "it is missing: the archive was not written by torch.save")
        })?;
    if let Some(mut input) = archive.open(&format!("{root}byteorder"), 64, source)? {
        let order = input.bytes(input.remaining(), "byte order")?;
        if order.trim_ascii() != b"little" {
            return Err(big_endian());
        }
    }
    let state_dict = match archive.open(&format!("{root}data.pkl"), MAX_PICKLE, source)? {
        Some(mut input) => StateDict::find(&pickle::run(&mut input, budget)?, budget)?,
        None => StateDict::default(),
    };

    contents(Format::TorchZip, state_dict, budget, |storage| {
        let name = format!("{root}data/{}", storage.key);
        let entry =
            archive.get(&name).ok_or_else(|| of_storage(storage, "the archive lacks it".into()))?;
        let bytes = size(storage)?;
        if entry.length < bytes {
            let problem = format!("it takes {bytes} bytes, but its entry has {}", entry.length);
            return Err(of_storage(storage, problem));
        }
        let checksum = entry.checksum.filter(|_| entry.length == bytes);
        let position = archive.position(&name, entry, source)?;
        Ok(Region { position, elements: storage.elements, checksum })
    })
}

fn is_folder(root: &str) -> bool {
    root.is_empty() || root.ends_with('/') && root.matches('/').count() == 1
}

/// Reads the older format, a single stream. It begins with pickles: the magic number, the version,
/// a dict about the machine, the object, and the keys of the storages. Then follows each storage,
/// its number of elements first.
pub(super) fn read_stream<R: Read + Seek>(
    source: &mut R,
    length: u64,
    budget: &mut Budget,
) -> Result<Contents, Error> {
    source.seek(SeekFrom::Start(0)).map_err(|error| reading(&error))?;
    let mut input = Input::new(BufReader::new(&mut *source), 0, length.min(MAX_PICKLE));
    input.skip(MAGIC.len() as u64, "magic number")?;
    if !matches!(pickle::run(&mut input, budget)?.root(), &Value::Int(STREAM_VERSION)) {
        return Err(malformed("the version 1001", &input));
    }
    let machine = pickle::run(&mut input, budget)?;
    match machine.entry(machine.root(), "little_endian") {
        Some(Value::Bool(true)) => {}
        Some(Value::Bool(false)) => return Err(big_endian()),
        _ => return Err(malformed("a dict that has \"little_endian\"", &input)),
    }
    let object = pickle::run(&mut input, budget)?;
    let key_list = pickle::run(&mut input, budget)?;
    let keys = texts(&key_list).ok_or_else(|| malformed("a list of storage keys", &input))?;
    let mut position = input.position();

    let state_dict = StateDict::find(&object, budget)?;
    let mut storages = BTreeMap::<&str, &Storage>::new();
    for storage in object.storages() {
        budget.take_entry::<&str, &Storage>(0)?;
        if storages.insert(&storage.key, storage).is_some_and(|other| other != storage) {
            return Err(of_storage(storage, "it is there with two sizes".into()));
        }
    }
    let mut regions = BTreeMap::new();
    for key in keys {
        budget.take_entry::<&str, Region>(3 * size_of::<&str>())?;
        let unknown = "no tensor of a known element type has it, so that its size is unknown";
        let storage = storages.get(key).ok_or_else(|| error::of_storage(key, unknown))?;
        let mut header = Input::open(source, position, 8, length)?;
        let elements = u64::from_le_bytes(header.array("storage")?);
        if usize::try_from(elements) != Ok(storage.elements) {
            let problem = format!("its size is {elements} elements, not {}", storage.elements);
            return Err(of_storage(storage, problem));
        }
        position += 8;
        let (needed, available) = (size(storage)?, length.saturating_sub(position));
        if needed > available {
            return Err(truncated("storage", position, needed, available));
        }
        regions.insert(key, Region { position, elements: storage.elements, checksum: None });
        position += needed;
    }
    contents(Format::TorchStream, state_dict, budget, |storage| {
        regions
            .get(&*storage.key)
            .copied()
            .ok_or_else(|| of_storage(storage, "the file lacks it".into()))
    })
}

/// Finds every tensor's position.
fn contents(
    format: Format,
    mut state_dict: StateDict,
    budget: &mut Budget,
    mut region: impl FnMut(&Storage) -> Result<Region, Error>,
) -> Result<Contents, Error> {
    let mut tensors = BTreeMap::new();
    for (name, view) in std::mem::take(&mut state_dict.tensors) {
        let heap = size_of_val(&*view.shape) + size_of_val(&*view.strides);
        budget.take_entry::<String, TensorInfo>(heap)?;
        let place = region(&view.storage)?;
        let View { storage, offset, shape, strides } = view;
        let info = TensorInfo::new(storage.element, shape.clone(), strides.clone(), offset, place);
        let Some(info) = info else {
            let place = format!(
                "of shape {shape:?}, strides {strides:?} and offset {offset}, it does not lie within \
                 its storage of {} elements",
                place.elements
            );
            return Err(of_tensor(&name, place));
        };
        tensors.insert(name, info);
    }
    let StateDict { wrappers, others, unread, .. } = state_dict;
    Ok(Contents { format, tensors, wrappers, others, unread })
}

/// Returns a storage's size (bytes).
fn size(storage: &Storage) -> Result<u64, Error> {
    (storage.elements as u64)
        .checked_mul(storage.element.size() as u64)
        .ok_or_else(|| of_storage(storage, format!("it has {} elements", storage.elements)))
}

fn texts(pickle: &Pickle) -> Option<Vec<&str>> {
    let Value::List(items) = pickle.root() else { return None };
    items
        .iter()
        .map(|&item| match pickle.value(item) {
            Value::Text(text) => Some(&**text),
            _ => None,
        })
        .collect()
}

fn of_storage(storage: &Storage, problem: String) -> Error {
    error::of_storage(&storage.key, problem)
}

fn malformed<R: BufRead>(expected: &'static str, input: &Input<R>) -> Error {
    in_pickle(input.position(), format_args!("expected {expected}"))
}
