//! The options `--shard` and `--shard-file`.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::part::Part;
use super::shard::Shard;
use crate::program::{OutputFile, ProgramError};

/// The share of the cases that a program computes.
#[derive(Args, Clone, Debug)]
pub struct ShardOptions {
    /// Compute only the I-th of N equal shares of the cases, for several machines; `merge` makes the whole result of
    /// the files of all shards.
    #[arg(long, value_name = "I/N", requires = "shard_file")]
    shard: Option<Shard>,
    /// The file for the shard's results.
    #[arg(long, value_name = "FILE", requires = "shard")]
    shard_file: Option<PathBuf>,
}

impl ShardOptions {
    /// The shard, or all cases if none is given.
    pub fn shard(&self) -> Shard {
        self.shard.unwrap_or_default()
    }

    /// Creates the shard's file, if one is asked for. Call this before the work, so that a wrong place is known early.
    ///
    /// # Errors
    /// As [`OutputFile::create`].
    pub fn create(&self) -> Result<Option<OutputFile>, ProgramError> {
        self.shard_file.as_ref().map(OutputFile::create).transpose()
    }

    /// Writes the file of [`create`](Self::create).
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write<Job, Case, Times>(
        file: Option<OutputFile>,
        part: &Part<Job, Case, Times>,
    ) -> anyhow::Result<()>
    where
        Job: Serialize + DeserializeOwned,
        Case: Serialize + DeserializeOwned,
        Times: Serialize + DeserializeOwned,
    {
        if let Some(mut file) = file {
            file.push(part.to_json()?.as_bytes())?;
            file.keep()?;
        }
        Ok(())
    }
}
