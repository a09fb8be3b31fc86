//! Merging of all shards of a run.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::error::ShardError;
use super::part::Part;

/// The merged results of all shards of a run.
#[derive(Clone, Debug)]
pub struct Merged<Job, Case, Times = ()> {
    /// The job.
    pub job: Job,
    /// Results of all cases in their order.
    pub results: Vec<Case>,
    /// Times of each shard.
    pub times: Vec<Times>,
}

impl<Job, Case, Times> Merged<Job, Case, Times>
where
    Job: PartialEq + Serialize + DeserializeOwned,
    Case: Serialize + DeserializeOwned,
    Times: Serialize + DeserializeOwned,
{
    /// Reads and merges the files of all shards, in any order.
    ///
    /// # Errors
    /// Those of [`Part::read`] and of [`of`](Self::of).
    pub fn read(files: &[PathBuf]) -> Result<Self, ShardError> {
        Self::of(files.iter().map(|path| Part::read(path)).collect::<Result<_, _>>()?)
    }

    /// Merges all shards, in any order.
    ///
    /// # Errors
    /// Shards of different runs, and shards that are missing, incomplete or given twice.
    pub fn of(mut parts: Vec<Part<Job, Case, Times>>) -> Result<Self, ShardError> {
        let first = parts.first().ok_or(ShardError::Nothing)?;
        let (count, cases) = (first.shard.count(), first.cases);
        for part in &parts {
            let what = if part.program != first.program {
                "another program"
            } else if part.job != first.job {
                "other options"
            } else if part.shard.count() != count || part.cases != cases {
                "another number of shards or cases"
            } else {
                continue;
            };
            let (shard, first) = (part.shard.to_string(), first.shard.to_string());
            return Err(ShardError::Different { shard, first, what });
        }
        parts.sort_by_key(|part| part.shard.index());
        let twice = parts.windows(2).find(|pair| pair[0].shard == pair[1].shard);
        if let Some([part, _]) = twice {
            return Err(ShardError::Twice { shard: part.shard.to_string() });
        }
        let there = |index: &u64| parts.iter().any(|part| part.shard.index() == *index);
        let missing: Vec<String> = (0..count)
            .filter(|index| !there(index))
            .map(|index| format!("{}/{count}", index + 1))
            .collect();
        if !missing.is_empty() {
            return Err(ShardError::Missing { missing: missing.join(", "), of: count });
        }
        for part in &parts {
            let own = part.shard.of(cases);
            if !own.eq(part.results.keys().copied()) {
                return Err(ShardError::Cases {
                    shard: part.shard.to_string(),
                    got: part.results.len(),
                    wanted: part.shard.of(cases).count(),
                });
            }
        }
        let (mut results, mut times, mut jobs) = (BTreeMap::new(), Vec::new(), Vec::new());
        for part in parts {
            results.extend(part.results);
            times.push(part.times);
            jobs.push(part.job);
        }
        let job = jobs.pop().ok_or(ShardError::Nothing)?;
        Ok(Self { job, results: results.into_values().collect(), times })
    }
}
