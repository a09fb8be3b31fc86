//! Safe display of external names on a terminal.

use std::{
    fmt::{self, Write},
    path::Path,
};

/// An external name, such as a file's, as it is shown. Characters that control a terminal or change the text direction
/// are escaped.
///
/// ```
/// use examples::program::shown;
///
/// assert_eq!(shown("folder/a b é.png").to_string(), "folder/a b é.png");
/// assert_eq!(shown("a\u{1b}[2Jb\n\u{202e}c").to_string(), "a\\u{1b}[2Jb\\n\\u{202e}c");
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Shown<'a>(&'a Path);

/// Returns the display of a name, such as a path.
pub fn shown<P: AsRef<Path> + ?Sized>(name: &P) -> Shown<'_> {
    Shown(name.as_ref())
}

/// True if a character is invisible: controls, line ends, and changes of the text direction.
fn steers(character: char) -> bool {
    character.is_control()
        || matches!(character, '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

impl fmt::Display for Shown<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(&printable(&self.0.to_string_lossy()))
    }
}

/// A text with its control characters escaped.
fn printable(text: &str) -> String {
    let mut printable = String::with_capacity(text.len());
    for character in text.chars() {
        if steers(character) {
            printable.extend(character.escape_default());
        } else {
            printable.push(character);
        }
    }
    printable
}

/// The bytes for a terminal with control characters escaped, except line ends and tabulators. `None` if there is
/// nothing to escape. Bytes that are not text stay.
pub(super) fn escaped(bytes: &[u8]) -> Option<Vec<u8>> {
    let stays = |character: char| matches!(character, '\n' | '\r' | '\t');
    let is_escaped = |character: char| steers(character) && !stays(character);
    let chunks = || bytes.utf8_chunks();
    if !chunks().any(|chunk| chunk.valid().contains(is_escaped)) {
        return None;
    }
    let mut escaped = Vec::with_capacity(bytes.len() + 16);
    let mut letter = [0; 4];
    for chunk in chunks() {
        for character in chunk.valid().chars() {
            if is_escaped(character) {
                escaped.extend(character.escape_default().map(|one| one as u8));
            } else {
                escaped.extend_from_slice(character.encode_utf8(&mut letter).as_bytes());
            }
        }
        escaped.extend_from_slice(chunk.invalid());
    }
    Some(escaped)
}

/// JSON with control characters in JSON's escapes, which only occur within its texts.
pub(super) fn json(text: &str) -> String {
    let mut json = String::with_capacity(text.len());
    let mut units = [0; 2];
    for character in text.chars() {
        if steers(character) {
            for unit in character.encode_utf16(&mut units) {
                // Writing to a string does not fail.
                let _ = write!(json, "\\u{unit:04x}");
            }
        } else {
            json.push(character);
        }
    }
    json
}
