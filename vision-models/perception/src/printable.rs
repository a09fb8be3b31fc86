//! Names and texts from files, for a terminal.

/// The most characters of a name that are shown.
const LONGEST: usize = 120;

/// A name from a file, such as a tensor's, on one line, as anybody may have chosen it: what cannot be printed is escaped,
/// and a long name is cut.
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
