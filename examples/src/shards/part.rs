//! The results of a shard, and their file.

use std::collections::BTreeMap;
use std::path::Path;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::error::ShardError;
use super::shard::Shard;
use crate::program::read_text;

/// Largest file of a shard (bytes).
const LARGEST: u64 = 1 << 30;

/// The results of a shard.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Part<Job, Case, Times = ()> {
    /// The program that computed it.
    pub program: String,
    /// The job, which is the same in all shards of a run.
    pub job: Job,
    /// The shard.
    pub shard: Shard,
    /// The number of cases of all shards.
    pub cases: u64,
    /// The results of its own cases.
    pub results: BTreeMap<u64, Case>,
    /// The computation times, which are the only part that depends on the machine.
    pub times: Times,
}

impl<Job, Case, Times> Part<Job, Case, Times>
where
    Job: Serialize + DeserializeOwned,
    Case: Serialize + DeserializeOwned,
    Times: Serialize + DeserializeOwned,
{
    /// The text of its file, a JSON object.
    ///
    /// # Errors
    /// Numbers that are not finite as map keys; see serde_json.
    pub fn to_json(&self) -> serde_json::Result<String> {
        Ok(serde_json::to_string(self)? + "\n")
    }

    /// Reads a file.
    ///
    /// # Errors
    /// [`ShardError::Read`], and [`ShardError::Broken`] for content that is not a part of this program.
    pub fn read(path: &Path) -> Result<Self, ShardError> {
        parse(path, &text(path)?)
    }
}

/// The name of the program that computed a file.
///
/// # Errors
/// As [`Part::read`].
pub fn program_of(path: &Path) -> Result<String, ShardError> {
    #[derive(Deserialize)]
    struct Head {
        program: String,
    }
    let Head { program } = parse(path, &text(path)?)?;
    Ok(program)
}

fn text(path: &Path) -> Result<String, ShardError> {
    read_text(path, LARGEST).map_err(|source| ShardError::Read { path: path.to_owned(), source })
}

fn parse<T: DeserializeOwned>(path: &Path, text: &str) -> Result<T, ShardError> {
    serde_json::from_str(text)
        .map_err(|error| ShardError::Broken { path: path.to_owned(), reason: error.to_string() })
}
