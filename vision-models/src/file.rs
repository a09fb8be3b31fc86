//! Files and texts from outside, taken into memory up to a limit.

use std::{fs::File, io::Read, path::Path};

use crate::error::Error;

/// Reads a file of at most `limit` bytes.
///
/// # Errors
/// [`Error::File`] if it cannot be read or is larger.
pub(crate) fn read_bytes(path: &Path, limit: u64) -> Result<Vec<u8>, Error> {
    let refuse = |reason: String| Error::File { path: path.display().to_string(), reason };
    let of_system = |error: std::io::Error| refuse(error.to_string());
    let too_large = || refuse(format!("larger than the {limit} bytes that such a file may have"));
    let file = File::open(path).map_err(of_system)?;
    if file.metadata().map_err(of_system)?.len() > limit {
        return Err(too_large());
    }
    // A device or a pipe has no length: what comes is counted.
    let mut bytes = Vec::new();
    file.take(limit.saturating_add(1)).read_to_end(&mut bytes).map_err(of_system)?;
    if bytes.len() as u64 > limit { Err(too_large()) } else { Ok(bytes) }
}

/// Reads a text of at most `limit` bytes.
///
/// # Errors
/// [`Error::File`] if it cannot be read, is larger or is not UTF-8.
pub(crate) fn read_text(path: &Path, limit: u64) -> Result<String, Error> {
    String::from_utf8(read_bytes(path, limit)?).map_err(|error| Error::File {
        path: path.display().to_string(),
        reason: format!("not UTF-8 text: byte {}", error.utf8_error().valid_up_to()),
    })
}

/// The text behind a byte-order mark, which some editors write at the start.
pub(crate) fn without_byte_order_mark(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}
