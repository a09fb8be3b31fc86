//! Names from outside on a terminal.

use std::{
    fmt::{self, Write},
    path::Path,
};

/// A name from outside, such as a file's, as it is shown: characters that would steer a terminal or turn the direction
/// of the text round it are escaped.
///
/// ```
/// use examples::program::shown;
///
/// assert_eq!(shown("folder/a b é.png").to_string(), "folder/a b é.png");
/// assert_eq!(shown("a\u{1b}[2Jb\n\u{202e}c").to_string(), "a\\u{1b}[2Jb\\n\\u{202e}c");
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Shown<'a>(&'a Path);

/// Shows a name, such as a path.
pub fn shown<P: AsRef<Path> + ?Sized>(name: &P) -> Shown<'_> {
    Shown(name.as_ref())
}

/// Whether a character is none to be seen: controls, line ends, and those that turn the direction of the text round them.
fn steers(character: char) -> bool {
    character.is_control()
        || matches!(character, '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

impl fmt::Display for Shown<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(&printable(&self.0.to_string_lossy()))
    }
}

/// A text without characters that steer.
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

/// What is written to a terminal, with the characters that steer escaped, but for line ends and tabulators; `None` where
/// there is nothing to escape. Bytes that are no text stay.
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

/// JSON with the characters that steer as JSON escapes them; they stand within its texts alone.
pub(super) fn json(text: &str) -> String {
    let mut json = String::with_capacity(text.len());
    let mut units = [0; 2];
    for character in text.chars() {
        if steers(character) {
            for unit in character.encode_utf16(&mut units) {
                // Writing to a text does not fail.
                let _ = write!(json, "\\u{unit:04x}");
            }
        } else {
            json.push(character);
        }
    }
    json
}
