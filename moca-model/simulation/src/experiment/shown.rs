//! The page of a case.

use moca_replay::page::{Results, page};
use moca_replay::recorded::ReplayError;
use serde::Serialize;

use super::player::ShownRun;
use crate::error::Error;
use crate::run::Comparison;

/// The runs of a case, and their results.
#[derive(Debug, Serialize)]
pub struct Shown {
    /// Number of the case.
    case: u64,
    #[serde(flatten)]
    comparison: Comparison,
    #[serde(skip)]
    runs: Vec<ShownRun>,
}

impl Shown {
    /// Creates the page's content from the runs of a case; `None` without runs.
    pub fn of(case: u64, runs: Vec<ShownRun>) -> Option<Self> {
        let first = runs.first()?;
        let comparison = Comparison {
            separation: first.separation,
            on: first.summary.clone(),
            off: runs.get(1).map(|run| run.summary.clone()),
        };
        Some(Self { case, comparison, runs })
    }

    /// The page of a case of this experiment, with the table of all cases.
    ///
    /// # Errors
    /// A run without a tick.
    pub fn page(&self, experiment: &str, table: &str) -> Result<String, Error> {
        let results = Results {
            summary: serde_json::to_value(self).map_err(ReplayError::Json)?,
            ..self.comparison.results(table.trim_end())?
        };
        let replays: Vec<_> = self.runs.iter().map(|run| &run.replay).collect();
        Ok(page(&format!("{experiment}: case {}", self.case), &replays, &results)?)
    }
}
