//! What several tests need.

use ahqp_core::{Error, Hierarchy, LevelId};

/// The id of a level by its place.
pub(crate) fn id(hierarchy: &Hierarchy, index: usize) -> LevelId {
    hierarchy.ids().nth(index).unwrap()
}

/// The message holds each of the words.
pub(crate) fn expect_words(error: &Error, words: &[&str]) {
    let message = error.to_string();
    for word in words {
        assert!(message.contains(word), "`{message}` does not say `{word}`");
    }
}
