//! An experiment as a list of independent cases, which several machines may share.

use std::fmt::Display;
use std::sync::Arc;

use ergo_map::ErgonomicsMap;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::player::Player;
use super::recorded::{Needs, Recorded};
use super::sight::Sight;
use crate::Error;
use crate::plant::Drive;

/// What is the same in all cases of an experiment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Conditions {
    /// What the robot does with commands.
    pub drive: Drive,
    /// How the robot sees the person.
    pub sight: Sight,
}

/// What is to be played: all that the results depend on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Job {
    /// Seed of everything random.
    pub seed: u64,
    /// How many random cases are asked for.
    pub cases: u64,
    /// Length of a random case \[s\].
    pub duration: f64,
    /// What is the same in all cases.
    pub conditions: Conditions,
    /// What tells the recordings apart that are played in place of random cases, such as digests.
    pub recordings: Vec<String>,
}

/// Independent cases, and what they come to together: Experiment 3, 4 or 5.
pub trait Experiment {
    /// Its name.
    const NAME: &'static str;
    /// What recordings must hold.
    const NEEDS: Needs;
    /// What is played; everything random in it comes from the seed and its number.
    type Case: Sync;
    /// What a case came to.
    type Trial: Send + Serialize + DeserializeOwned;
    /// What all came to: a table, and an object with its numbers.
    type Outcome: Display + Serialize;

    /// The cases of a job: of its recordings, or random ones if there are none.
    fn cases(job: &Job, recordings: &[Arc<Recorded>]) -> Vec<Self::Case>;

    /// Plays one; the map is that of the average person.
    ///
    /// # Errors
    /// Settings that the controller refuses.
    fn play(
        case: &Self::Case,
        average: &ErgonomicsMap,
        conditions: Conditions,
        player: &mut Player<'_>,
    ) -> Result<Self::Trial, Error>;

    /// What trials came to, in the order of their cases.
    fn outcome(trials: Vec<Self::Trial>) -> Self::Outcome;

    /// The figure of an outcome, as SVG.
    ///
    /// # Errors
    /// A figure that cannot be drawn.
    fn figure(outcome: &Self::Outcome) -> Result<String, Error>;
}
