//! What one shard has computed, and the file that holds it.

use std::collections::BTreeMap;
use std::path::Path;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::error::ShardError;
use super::shard::Shard;
use crate::program::read_text;

/// The largest file of a shard (bytes).
const LARGEST: u64 = 1 << 30;

/// The results of a shard.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Part<Job, Case, Times = ()> {
    /// Which program computed it.
    pub program: String,
    /// What was to be computed; the same in all shards of a run.
    pub job: Job,
    /// Which shard it is.
    pub shard: Shard,
    /// How many cases all shards have together.
    pub cases: u64,
    /// The results of its own cases.
    pub results: BTreeMap<u64, Case>,
    /// How long that took: the only thing that differs from machine to machine.
    pub times: Times,
}

impl<Job, Case, Times> Part<Job, Case, Times>
where
    Job: Serialize + DeserializeOwned,
    Case: Serialize + DeserializeOwned,
    Times: Serialize + DeserializeOwned,
{
    /// The text of its file, one JSON object.
    ///
    /// # Errors
    /// Numbers that are not finite in place of map keys, as serde_json says.
    pub fn to_json(&self) -> serde_json::Result<String> {
        Ok(serde_json::to_string(self)? + "\n")
    }

    /// Reads a file.
    ///
    /// # Errors
    /// [`ShardError::Read`], and [`ShardError::Broken`] for what is no part of this program.
    pub fn read(path: &Path) -> Result<Self, ShardError> {
        parse(path, &text(path)?)
    }
}

/// The program that computed a file.
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
