//! Whom the robot sees.

use std::sync::Arc;

use vision_models::Tool;

use super::recorded::Recorded;
use super::sight::Sight;
use super::walk::Walk;
use crate::Error;
use crate::people::WalkerSettings;

/// A person: one who is simulated, or one who was recorded.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// Simulated.
    Simulated(WalkerSettings),
    /// Recorded.
    Recorded {
        /// What was recorded.
        recording: Arc<Recorded>,
        /// Of everything else that is random.
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

    /// Of the person \[m\].
    pub fn stature(&self) -> f64 {
        match self {
            Self::Simulated(walker) => walker.stature,
            Self::Recorded { recording, .. } => recording.stature,
        }
    }

    /// What the person works with.
    pub fn tool(&self) -> Tool {
        match self {
            Self::Simulated(walker) => walker.tool,
            Self::Recorded { recording, .. } => recording.tool,
        }
    }

    /// Seed of everything random but the person.
    pub fn seed(&self) -> u64 {
        match self {
            Self::Simulated(walker) => walker.seed,
            Self::Recorded { seed, .. } => *seed,
        }
    }

    /// What the robot sees of them, and where they are. What was recorded is as it is, however the robot sees.
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
