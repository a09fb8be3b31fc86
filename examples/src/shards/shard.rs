//! One of several equal shares of the cases.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::error::ShardError;

/// The I-th of N shards, which holds every N-th case.
///
/// ```
/// use examples::shards::Shard;
///
/// let second: Shard = "2/4".parse()?;
/// assert_eq!(second.of(10).collect::<Vec<_>>(), [1, 5, 9]);
/// assert!("5/4".parse::<Shard>().is_err());
/// # Ok::<(), examples::shards::ShardError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Shard {
    /// Index of the shard, from 0.
    index: u64,
    count: u64,
}

impl Shard {
    /// The only shard, with all cases.
    pub const WHOLE: Self = Self { index: 0, count: 1 };

    /// The index, from 0.
    pub fn index(self) -> u64 {
        self.index
    }

    /// The number of shards.
    pub fn count(self) -> u64 {
        self.count
    }

    /// Returns true if this case belongs to the shard.
    pub fn contains(self, case: u64) -> bool {
        case % self.count == self.index
    }

    /// The shard's cases among `cases`.
    pub fn of(self, cases: u64) -> impl Iterator<Item = u64> {
        (0..cases).filter(move |case| self.contains(*case))
    }
}

impl Default for Shard {
    fn default() -> Self {
        Self::WHOLE
    }
}

impl FromStr for Shard {
    type Err = ShardError;

    fn from_str(text: &str) -> Result<Self, ShardError> {
        let fail = || ShardError::Form { found: text.to_owned() };
        let (index, count) = text.split_once('/').ok_or_else(fail)?;
        let number = |text: &str| text.parse::<u32>().map(u64::from).map_err(|_| fail());
        let (index, count) = (number(index)?, number(count)?);
        if index == 0 || index > count {
            return Err(fail());
        }
        Ok(Self { index: index - 1, count })
    }
}

impl TryFrom<String> for Shard {
    type Error = ShardError;

    fn try_from(text: String) -> Result<Self, ShardError> {
        text.parse()
    }
}

impl From<Shard> for String {
    fn from(shard: Shard) -> Self {
        shard.to_string()
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index + 1, self.count)
    }
}
