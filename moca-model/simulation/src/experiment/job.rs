//! Experiments as lists of independent cases, which several machines may share.

use std::fmt::Display;
use std::sync::Arc;

use ergo_map::ErgonomicsMap;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::conditions::Conditions;
use super::player::Player;
use super::recorded::{Needs, Recorded};
use crate::error::Error;

/// A job: everything that the results depend on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Job {
    /// Seed of everything random.
    pub seed: u64,
    /// Number of random cases.
    pub cases: u64,
    /// Length of a random case \[s\].
    pub duration: f64,
    /// Conditions that all cases share.
    pub conditions: Conditions,
    /// Identifiers of the recordings that replace random cases, such as digests.
    pub recordings: Vec<String>,
}

/// An experiment of independent cases and their common result: Experiment 3, 4 or 5.
pub trait Experiment {
    /// Name of the experiment.
    const NAME: &'static str;
    /// Contents that recordings must have.
    const NEEDS: Needs;
    /// A case, whose random numbers come from the seed and its number.
    type Case: Sync;
    /// The result of a case.
    type Trial: Send + Serialize + DeserializeOwned;
    /// The result of all cases: a table, and an object with its numbers.
    type Outcome: Display + Serialize;

    /// The cases of a job: its recordings, or random ones if there are none.
    fn cases(job: &Job, recordings: &[Arc<Recorded>]) -> Vec<Self::Case>;

    /// Plays a case. The map is that of the average person.
    ///
    /// # Errors
    /// Settings that the controller refuses.
    fn play(
        case: &Self::Case,
        average: &ErgonomicsMap,
        conditions: Conditions,
        player: &mut Player<'_>,
    ) -> Result<Self::Trial, Error>;

    /// The result of trials in the order of their cases.
    fn outcome(trials: Vec<Self::Trial>) -> Self::Outcome;

    /// The figure of an outcome, as SVG.
    ///
    /// # Errors
    /// A figure that cannot be drawn.
    fn figure(outcome: &Self::Outcome) -> Result<String, Error>;
}
