//! What an error quotes of what it was given.

/// The most that is quoted (characters).
const LONGEST: usize = 120;

/// A text, or its beginning where it is long.
pub(crate) fn excerpt(text: &str) -> String {
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", text.get(..end).unwrap_or_default()),
        None => text.to_owned(),
    }
}
