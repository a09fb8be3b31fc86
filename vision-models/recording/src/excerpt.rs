//! Excerpts of given text for errors.

/// Longest excerpt (characters).
const LONGEST: usize = 120;

/// Returns a text, or its beginning if it is long.
pub(crate) fn excerpt(text: &str) -> String {
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", text.get(..end).unwrap_or_default()),
        None => text.to_owned(),
    }
}
