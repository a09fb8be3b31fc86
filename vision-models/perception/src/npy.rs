//! Reading NumPy's arrays of single precision, whatever their headers claim.

use std::{
    fs::File,
    io::{BufReader, Cursor, Read},
    path::Path,
};

use ndarray::ArrayD;
use ndarray_npy::{ReadNpyExt, npy::header::Header};

use crate::error::Error;

const MAGIC: &[u8] = b"\x93NUMPY";
/// More than the header of any array without fields takes (bytes).
const MAX_HEADER: usize = 4096;
/// More brackets than there are inside each other in such a header.
const MAX_DEPTH: usize = 8;
/// The size of an element (bytes).
const ELEMENT: u64 = 4;

/// Reads an array of f32 from a `.npy` file. No memory is taken for data that the file does not
/// hold.
///
/// # Errors
/// Names the file's name, if it cannot be read, is no such array or is cut off.
pub fn read_array(path: &Path) -> Result<ArrayD<f32>, Error> {
    let place = format!("cannot read {} as an f32 array", path.display());
    let file = File::open(path).map_err(|error| error.to_string());
    file.and_then(read).map_err(|found| Error::at(place, found))
}

fn read(file: File) -> Result<ArrayD<f32>, String> {
    let metadata = file.metadata().map_err(text)?;
    let mut reader = BufReader::new(file);
    let bytes = header_bytes(&mut reader)?;
    // What the parser says takes several lines.
    let header = Header::from_reader(&mut bytes.as_slice())
        .map_err(|_| "its header is no dictionary of descr, fortran_order and shape")?;
    let claimed = data_size(&header)?;
    let cut_off = |found: u64| {
        let shape = &header.shape;
        format!("its shape {shape:?} takes {claimed} bytes, but it has {found}: it is cut off")
    };
    let start = Cursor::new(&bytes);
    if metadata.is_file() {
        let found = metadata.len().saturating_sub(bytes.len() as u64);
        if claimed > found {
            return Err(cut_off(found));
        }
        if !has_memory_for(claimed) {
            return Err(format!("its shape {:?} takes more memory than there is", header.shape));
        }
        return ArrayD::read_npy(start.chain(reader)).map_err(text);
    }
    // A pipe does not say how much is to come.
    let mut data = Vec::new();
    reader.take(claimed.saturating_add(1)).read_to_end(&mut data).map_err(text)?;
    if claimed > data.len() as u64 {
        return Err(cut_off(data.len() as u64));
    }
    ArrayD::read_npy(start.chain(data.as_slice())).map_err(text)
}

fn text(error: impl std::fmt::Display) -> String {
    error.to_string()
}

/// The header with what stands before it, checked for its length and depth.
fn header_bytes(reader: &mut impl Read) -> Result<Vec<u8>, String> {
    // The magic string, two bytes of version, and two bytes of length in version 1, else four.
    let mut bytes = vec![0; MAGIC.len() + 2];
    let read = reader.read_exact(&mut bytes);
    if read.is_err() || !bytes.starts_with(MAGIC) {
        return Err("it is no .npy file".to_owned());
    }
    let mut size = [0; 4];
    let width = if bytes.get(MAGIC.len()) == Some(&1) { 2 } else { 4 };
    let digits = size.get_mut(..width).unwrap_or_default();
    reader.read_exact(digits).map_err(text)?;
    bytes.extend_from_slice(digits);
    let length = usize::try_from(u32::from_le_bytes(size)).map_err(text)?;
    if length > MAX_HEADER {
        return Err(format!("its header has {length} bytes, more than {MAX_HEADER}"));
    }
    let start = bytes.len();
    bytes.resize(start + length, 0);
    let dictionary = bytes.get_mut(start..).unwrap_or_default();
    reader.read_exact(dictionary).map_err(|_| "its header is cut off")?;

    let mut depth = 0_usize;
    for byte in dictionary {
        match byte {
            b'(' | b'[' | b'{' => depth += 1,
            b')' | b']' | b'}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth > MAX_DEPTH {
            return Err(format!("its header has more than {MAX_DEPTH} brackets in each other"));
        }
    }
    Ok(bytes)
}

/// The size of the data by what the header says (bytes).
fn data_size(header: &Header) -> Result<u64, String> {
    let kind = header.type_descriptor.to_string();
    if !["'<f4'", "'>f4'"].contains(&kind.as_str()) {
        return Err(format!(
            "its elements are {kind}, not f32: write it with .astype(numpy.float32)"
        ));
    }
    let size = header
        .shape
        .iter()
        .try_fold(ELEMENT, |size, &axis| size.checked_mul(u64::try_from(axis).ok()?));
    size.ok_or_else(|| format!("its shape {:?} is beyond all bounds", header.shape))
}

/// Returns true if the system would give so much memory (bytes). A file with holes can be larger
/// than the machine.
fn has_memory_for(bytes: u64) -> bool {
    let mut probe: Vec<u8> = Vec::new();
    usize::try_from(bytes).is_ok_and(|bytes| probe.try_reserve_exact(bytes).is_ok())
}
