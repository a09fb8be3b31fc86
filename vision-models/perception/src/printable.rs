//! Names and texts from files, made printable for a terminal.

/// Largest number of characters of a name that are shown.
const LONGEST: usize = 120;

/// Returns an untrusted name from a file, such as a tensor's, on one line. Unprintable characters
/// are escaped, and a long name is cut.
///
/// ```
/// use human_perception::printable;
///
/// assert_eq!(printable("layer1.0.conv1.weight"), "layer1.0.conv1.weight");
/// assert_eq!(printable("fc\n\u{1b}[2J"), "fc\\n\\u{1b}[2J");
/// ```
pub fn printable(name: &str) -> String {
    let mut shown = String::new();
    for character in name.chars().take(LONGEST) {
        match character {
            '"' | '\'' => shown.push(character),
            _ => shown.extend(character.escape_debug()),
        }
    }
    if name.chars().nth(LONGEST).is_some() {
        shown.push('…');
    }
    shown
}
