//! Reading files into memory up to a size limit, and quoting what they contain.

use std::{
    fs::File,
    io::{self, Read},
    path::Path,
};

#[cfg(feature = "inference")]
use crate::error::Error;
pub use crate::excerpt::Excerpt;

/// Reads a file of at most `limit` bytes. Devices and pipes, which have no length, are read no
/// further either.
///
/// ```
/// use vision_models::file::read_bytes;
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("four");
/// std::fs::write(&path, "four")?;
/// assert_eq!(read_bytes(&path, 4)?, b"four");
/// assert!(read_bytes(&path, 3).unwrap_err().to_string().contains("at most 3 bytes"));
/// # Ok::<(), std::io::Error>(())
/// ```
///
/// # Errors
/// Those of the operating system. [`io::ErrorKind::FileTooLarge`] if the file is larger, before
/// memory is allocated.
pub fn read_bytes(path: impl AsRef<Path>, limit: u64) -> io::Result<Vec<u8>> {
    let too_large = || {
        let text = format!("larger than such a file can be: at most {limit} bytes are read");
        io::Error::new(io::ErrorKind::FileTooLarge, text)
    };
    let file = File::open(path)?;
    if file.metadata()?.len() > limit {
        return Err(too_large());
    }
    let mut bytes = Vec::new();
    file.take(limit.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > limit { Err(too_large()) } else { Ok(bytes) }
}

/// Reads a text of at most `limit` bytes.
///
/// # Errors
/// Those of [`read_bytes`]. [`io::ErrorKind::InvalidData`] with the position if the text is not
/// UTF-8.
pub fn read_text(path: impl AsRef<Path>, limit: u64) -> io::Result<String> {
    String::from_utf8(read_bytes(path, limit)?).map_err(|error| {
        let place = error.utf8_error().valid_up_to();
        io::Error::new(io::ErrorKind::InvalidData, format!("not UTF-8 text: byte {place}"))
    })
}

/// Adds the file's name to an error of reading.
#[cfg(feature = "inference")]
pub(crate) fn in_file(path: &Path) -> impl Fn(io::Error) -> Error {
    |error| Error::File { path: path.display().to_string(), reason: error.to_string() }
}

/// Returns the text without the byte-order mark that some editors write at the start.
#[cfg(feature = "inference")]
pub(crate) fn without_byte_order_mark(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}
