//! Excerpts of given text for errors.

use std::fmt;

/// The start of a text from outside, so that no file makes a message long. Control characters are
/// escaped, so that the message stays on one line.
pub(crate) struct Excerpt<'a>(pub(crate) &'a str);

impl Excerpt<'_> {
    const LENGTH: usize = 120;
}

impl fmt::Display for Excerpt<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for character in self.0.chars().take(Self::LENGTH) {
            if character.is_control() {
                write!(formatter, "{}", character.escape_default())?;
            } else {
                write!(formatter, "{character}")?;
            }
        }
        if self.0.chars().nth(Self::LENGTH).is_some() { formatter.write_str("…") } else { Ok(()) }
    }
}
