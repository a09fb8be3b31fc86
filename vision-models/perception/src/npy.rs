//! Reads and writes NumPy's arrays of single precision, with safe limits for any header.

use std::{
    fmt::Display,
    fs::File,
    io::{self, BufReader, Read, Write},
    path::Path,
};

use ndarray::{Array, ArrayD, Dimension, IxDyn, ShapeBuilder};

use crate::error::Error;

const MAGIC: &[u8] = b"\x93NUMPY";
/// Largest header (bytes). No array without fields needs more.
const MAX_HEADER: usize = 4096;
/// The size of an element (bytes).
const ELEMENT: usize = size_of::<f32>();
/// Alignment of the data (bytes).
const ALIGNMENT: usize = 64;

/// Reads an array of f32 from a `.npy` file. No memory is allocated for data that the file does not
/// hold.
///
/// # Errors
/// Names the file if it cannot be read, is no such array or is truncated.
pub fn read_array(path: &Path) -> Result<ArrayD<f32>, Error> {
    let place = format!("cannot read {} as an f32 array", path.display());
    let file = File::open(path).map_err(text);
    file.and_then(read).map_err(|found| Error::at(place, found))
}

/// Writes an array of f32 as a `.npy` file, little-endian and row by row.
///
/// ```
/// use human_perception::npy::write_array;
/// use ndarray::array;
///
/// let mut file = Vec::new();
/// write_array(&mut file, &array![[1.0, 2.0]])?;
/// assert!(file[10..].starts_with(b"{'descr': '<f4', 'fortran_order': False, 'shape': (1, 2)}"));
/// assert_eq!(file[128..], [1.0_f32.to_le_bytes(), 2.0_f32.to_le_bytes()].concat());
/// # Ok::<(), std::io::Error>(())
/// ```
///
/// # Errors
/// Those of the writer.
pub fn write_array<D: Dimension>(writer: &mut impl Write, array: &Array<f32, D>) -> io::Result<()> {
    let axes: Vec<String> = array.shape().iter().map(usize::to_string).collect();
    let comma = if axes.len() == 1 { "," } else { "" };
    let mut header = format!(
        "{{'descr': '<f4', 'fortran_order': False, 'shape': ({}{comma})}}",
        axes.join(", ")
    );
    let start = MAGIC.len() + 4;
    let padding = ALIGNMENT - (start + header.len() + 1) % ALIGNMENT;
    header.push_str(&" ".repeat(padding));
    header.push('\n');
    let length = u16::try_from(header.len()).map_err(io::Error::other)?;
    writer.write_all(MAGIC)?;
    writer.write_all(&[1, 0])?;
    writer.write_all(&length.to_le_bytes())?;
    writer.write_all(header.as_bytes())?;
    let data: Vec<u8> = array.iter().flat_map(|value| value.to_le_bytes()).collect();
    writer.write_all(&data)
}

/// The header before the data.
struct Header {
    /// Type of the elements, such as `<f4`.
    kind: String,
    /// True if the first axis changes fastest.
    fortran_order: bool,
    shape: Vec<usize>,
}

impl Header {
    /// Reads Python's dictionary of three known entries.
    fn parse(dictionary: &str) -> Option<Self> {
        let (mut kind, mut fortran_order, mut shape) = (None, None, None);
        let mut rest = dictionary.trim().strip_prefix('{')?.strip_suffix('}')?.trim();
        while !rest.is_empty() {
            let (key, value) = quoted(rest)?;
            let value = value.trim_start().strip_prefix(':')?.trim_start();
            let after;
            match key {
                "descr" => {
                    let text;
                    (text, after) = quoted(value)?;
                    kind = Some(text.to_owned());
                }
                "fortran_order" => {
                    let is_fortran = value.starts_with("True");
                    after = value.strip_prefix(if is_fortran { "True" } else { "False" })?;
                    fortran_order = Some(is_fortran);
                }
                "shape" => {
                    let tuple;
                    (tuple, after) = value.strip_prefix('(')?.split_once(')')?;
                    let tuple = tuple.trim_end();
                    let axes = tuple.strip_suffix(',').unwrap_or(tuple);
                    let axes = axes.split(',').filter(|_| !axes.is_empty());
                    shape = Some(axes.map(|axis| axis.trim().parse().ok()).collect::<Option<_>>()?);
                }
                _ => return None,
            }
            rest = after.trim_start();
            rest = rest.strip_prefix(',').unwrap_or(rest).trim_start();
        }
        Some(Self { kind: kind?, fortran_order: fortran_order?, shape: shape? })
    }

    /// Returns the number of elements.
    fn count(&self) -> Result<usize, String> {
        let count = self.shape.iter().try_fold(1_usize, |count, &axis| count.checked_mul(axis));
        let bytes = count.and_then(|count| count.checked_mul(ELEMENT));
        count
            .filter(|_| bytes.is_some())
            .ok_or_else(|| format!("its shape {:?} is beyond all bounds", self.shape))
    }
}

/// Returns a text in quotes and the rest.
fn quoted(text: &str) -> Option<(&str, &str)> {
    let quote = text.chars().next().filter(|quote| ['\'', '"'].contains(quote))?;
    text.get(1..)?.split_once(quote)
}

fn read(file: File) -> Result<ArrayD<f32>, String> {
    let metadata = file.metadata().map_err(text)?;
    let mut reader = BufReader::new(file);
    let (header, start) = read_header(&mut reader)?;
    let kind = header.kind.as_str();
    let number: fn([u8; ELEMENT]) -> f32 = match kind {
        "<f4" => f32::from_le_bytes,
        ">f4" => f32::from_be_bytes,
        _ => {
            return Err(format!(
                "its elements are '{kind}', not f32: write it with .astype(numpy.float32)"
            ));
        }
    };
    let count = header.count()?;
    let claimed = (count * ELEMENT) as u64;
    let shape = &header.shape;
    let cut_off = |found: u64| {
        format!("its shape {shape:?} takes {claimed} bytes, but it has {found}: it is cut off")
    };
    let mut values = Vec::new();
    // The length of a pipe is unknown.
    if metadata.is_file() {
        let found = metadata.len().saturating_sub(start as u64);
        if claimed > found {
            return Err(cut_off(found));
        }
        // A sparse file can be larger than the machine's memory.
        values
            .try_reserve_exact(count)
            .map_err(|_| format!("its shape {shape:?} takes more memory than there is"))?;
    }
    let mut bytes = [0; ELEMENT];
    while values.len() < count {
        match reader.read_exact(&mut bytes) {
            Ok(()) => values.push(number(bytes)),
            Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => {
                return Err(cut_off((values.len() * ELEMENT) as u64));
            }
            Err(error) => return Err(text(error)),
        }
    }
    if reader.read(&mut bytes).map_err(text)? > 0 {
        return Err(format!("it has more than the {claimed} bytes that its shape {shape:?} takes"));
    }
    let shape = IxDyn(shape).set_f(header.fortran_order);
    ArrayD::from_shape_vec(shape, values).map_err(text)
}

fn text(error: impl Display) -> String {
    error.to_string()
}

/// Reads the header and returns the position where the data begin.
fn read_header(reader: &mut impl Read) -> Result<(Header, usize), String> {
    // The magic string, two bytes of version, and two bytes of length in version 1, otherwise four.
    let mut start = [0; MAGIC.len() + 2];
    let read = reader.read_exact(&mut start);
    if read.is_err() || !start.starts_with(MAGIC) {
        return Err("it is no .npy file".to_owned());
    }
    let mut size = [0; 4];
    let width = if start.get(MAGIC.len()) == Some(&1) { 2 } else { 4 };
    reader.read_exact(size.get_mut(..width).unwrap_or_default()).map_err(text)?;
    let length = usize::try_from(u32::from_le_bytes(size)).map_err(text)?;
    if length > MAX_HEADER {
        return Err(format!("its header has {length} bytes, more than {MAX_HEADER}"));
    }
    let mut dictionary = vec![0; length];
    reader.read_exact(&mut dictionary).map_err(|_| "its header is cut off")?;
    let header = std::str::from_utf8(&dictionary).ok().and_then(Header::parse);
    let header = header.ok_or("its header is no dictionary of descr, fortran_order and shape")?;
    Ok((header, start.len() + width + length))
}
