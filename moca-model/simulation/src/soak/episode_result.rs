//! Result of an episode of the soak.

use serde::{Deserialize, Serialize};

use super::disturbance::Endings;
use super::monitor::Counts;
use crate::judges::Stillness;

/// Result of an episode.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EpisodeResult {
    /// Ticks run.
    pub ticks: u64,
    /// Ticks with something wrong.
    pub counts: Counts,
    /// Endings of disturbances.
    pub ended: Endings,
    /// Ticks in which the robot moves.
    pub moving: u64,
    /// Stillness while the person stands.
    pub standing: Stillness,
    /// The first tick with something wrong, in words.
    pub finding: Option<String>,
}
