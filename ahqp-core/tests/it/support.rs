//! Helpers of several tests.

use ahqp_core::{Error, Hierarchy, LevelId};

/// Returns the id of a level by its index.
pub(crate) fn id(hierarchy: &Hierarchy, index: usize) -> LevelId {
    hierarchy.ids().nth(index).unwrap()
}

/// Expects that the message contains each of the words.
pub(crate) fn expect_words(error: &Error, words: &[&str]) {
    let message = error.to_string();
    for word in words {
        assert!(message.contains(word), "`{message}` does not say `{word}`");
    }
}
