//! Reading NumPy's arrays of single precision, whatever their headers claim.

use std::{
    fs::File,
    io::{BufReader, Cursor, Read},
    path::Path,
};

use anyhow::{Context, Result, anyhow, bail, ensure};
use ndarray::ArrayD;
use ndarray_npy::{ReadNpyExt, npy::header::Header};

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
/// With the file's name, if it cannot be read, is no such array or is cut off.
pub fn read_array(path: &Path) -> Result<ArrayD<f32>> {
    File::open(path)
        .map_err(anyhow::Error::from)
        .and_then(read)
        .with_context(|| format!("cannot read {} as an f32 array", path.display()))
}

fn read(file: File) -> Result<ArrayD<f32>> {
    let metadata = file.metadata()?;
    let mut reader = BufReader::new(file);
    let bytes = header_bytes(&mut reader)?;
    // What the parser says takes several lines.
    let header = Header::from_reader(&mut bytes.as_slice())
        .map_err(|_| anyhow!("its header is no dictionary of descr, fortran_order and shape"))?;
    let claimed = data_size(&header)?;
    let cut_off = |found: u64| {
        let shape = &header.shape;
        format!("its shape {shape:?} takes {claimed} bytes, but it has {found}: it is cut off")
    };
    let start = Cursor::new(&bytes);
    if metadata.is_file() {
        let found = metadata.len().saturating_sub(bytes.len() as u64);
        ensure!(claimed <= found, cut_off(found));
        ensure!(
            has_memory_for(claimed),
            "its shape {:?} takes more memory than there is",
            header.shape
        );
        return Ok(ArrayD::read_npy(start.chain(reader))?);
    }
    // A pipe does not say how much is to come.
    let mut data = Vec::new();
    reader.take(claimed.saturating_add(1)).read_to_end(&mut data)?;
    ensure!(claimed <= data.len() as u64, cut_off(data.len() as u64));
    Ok(ArrayD::read_npy(start.chain(data.as_slice()))?)
}

/// The header with what stands before it, checked for its length and depth.
fn header_bytes(reader: &mut impl Read) -> Result<Vec<u8>> {
    // The magic string, two bytes of version, and two bytes of length in version 1, else four.
    let mut bytes = vec![0; MAGIC.len() + 2];
    reader.read_exact(&mut bytes).context("it is no .npy file")?;
    ensure!(bytes.starts_with(MAGIC), "it is no .npy file");
    let mut size = [0; 4];
    let width = if bytes.get(MAGIC.len()) == Some(&1) { 2 } else { 4 };
    let digits = size.get_mut(..width).unwrap_or_default();
    reader.read_exact(digits)?;
    bytes.extend_from_slice(digits);
    let length = usize::try_from(u32::from_le_bytes(size))?;
    ensure!(length <= MAX_HEADER, "its header has {length} bytes, more than {MAX_HEADER}");
    let start = bytes.len();
    bytes.resize(start + length, 0);
    let text = bytes.get_mut(start..).unwrap_or_default();
    reader.read_exact(text).context("its header is cut off")?;

    let mut depth = 0_usize;
    for byte in text {
        match byte {
            b'(' | b'[' | b'{' => depth += 1,
            b')' | b']' | b'}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        ensure!(depth <= MAX_DEPTH, "its header has more than {MAX_DEPTH} brackets in each other");
    }
    Ok(bytes)
}

/// The size of the data by what the header says (bytes).
fn data_size(header: &Header) -> Result<u64> {
    let kind = header.type_descriptor.to_string();
    if !["'<f4'", "'>f4'"].contains(&kind.as_str()) {
        bail!("its elements are {kind}, not f32: write it with .astype(numpy.float32)");
    }
    let size = header
        .shape
        .iter()
        .try_fold(ELEMENT, |size, &axis| size.checked_mul(u64::try_from(axis).ok()?));
    size.with_context(|| format!("its shape {:?} is beyond all bounds", header.shape))
}

/// Returns true if the system would give so much memory (bytes). A file with holes can be larger
/// than the machine.
fn has_memory_for(bytes: u64) -> bool {
    let mut probe: Vec<u8> = Vec::new();
    usize::try_from(bytes).is_ok_and(|bytes| probe.try_reserve_exact(bytes).is_ok())
}
