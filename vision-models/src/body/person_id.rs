//! The number of a tracked person.

/// The number of a tracked person. No number is used twice.
///
/// ```
/// use vision_models::PersonId;
///
/// assert_eq!(PersonId::new(3).number(), 3);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PersonId(u64);

impl PersonId {
    /// Creates the id of a source that tracks people.
    pub const fn new(number: u64) -> Self {
        Self(number)
    }

    /// Returns the number that the source gave.
    pub fn number(self) -> u64 {
        self.0
    }
}
