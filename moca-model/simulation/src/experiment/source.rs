//! The people whom the robot sees.

use std::sync::Arc;

use simulated_people::WalkerSettings;
use vision_models::Tool;

use super::recorded::Recorded;
use super::sight::Sight;
use super::walk::Walk;
use crate::error::Error;

/// A simulated or recorded person.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// A simulated person.
    Simulated(WalkerSettings),
    /// A recorded person.
    Recorded {
        /// The recording.
        recording: Arc<Recorded>,
        /// Seed of all other random numbers.
        seed: u64,
    },
}

impl Source {
    /// Recorded people, in the order of their recordings.
    pub(super) fn of_recordings(recordings: &[Arc<Recorded>], seed: u64) -> Vec<(u64, Self)> {
        let sources = recordings
            .iter()
            .map(|recording| Self::Recorded { recording: Arc::clone(recording), seed });
        (0..).zip(sources).collect()
    }

    /// Stature of the person \[m\].
    pub fn stature(&self) -> f64 {
        match self {
            Self::Simulated(walker) => walker.stature,
            Self::Recorded { recording, .. } => recording.stature,
        }
    }

    /// The person's tool.
    pub fn tool(&self) -> Tool {
        match self {
            Self::Simulated(walker) => walker.tool,
            Self::Recorded { recording, .. } => recording.tool,
        }
    }

    /// Seed of all random numbers other than the person's.
    pub fn seed(&self) -> u64 {
        match self {
            Self::Simulated(walker) => walker.seed,
            Self::Recorded { seed, .. } => *seed,
        }
    }

    /// The percepts and the truth of the person. Recordings do not depend on `sight`.
    ///
    /// # Errors
    /// Settings that make no walk.
    pub fn walk(&self, sight: Sight) -> Result<Walk, Error> {
        match self {
            Self::Simulated(walker) => Walk::new(walker.clone(), sight),
            Self::Recorded { recording, .. } => Ok(recording.walk.clone()),
        }
    }
}
