//! Excerpts of given text for errors.

use std::fmt;

/// The start of a text from outside, such as the name of a tensor, for a message. It is short and on one line: what
/// cannot be printed is escaped.
///
/// ```
/// use vision_models::file::Excerpt;
///
/// assert_eq!(Excerpt("layer1.0.conv1.weight").to_string(), "layer1.0.conv1.weight");
/// assert_eq!(Excerpt("fc\n\u{1b}[2J").to_string(), "fc\\n\\u{1b}[2J");
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Excerpt<'a>(pub &'a str);

impl Excerpt<'_> {
    const LENGTH: usize = 120;
}

impl fmt::Display for Excerpt<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for character in self.0.chars().take(Self::LENGTH) {
            match character {
                '"' | '\'' | '\\' => write!(formatter, "{character}")?,
                _ => write!(formatter, "{}", character.escape_debug())?,
            }
        }
        if self.0.chars().nth(Self::LENGTH).is_some() { formatter.write_str("…") } else { Ok(()) }
    }
}
