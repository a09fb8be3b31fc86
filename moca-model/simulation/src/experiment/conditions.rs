//! Conditions of an experiment.

use serde::{Deserialize, Serialize};

use super::sight::Sight;
use crate::plant::Drive;
use crate::run::Scenario;

/// Conditions that all cases of an experiment share.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Conditions {
    /// The robot's dynamics.
    pub drive: Drive,
    /// Perception of the person by the robot.
    pub sight: Sight,
    /// True if the robot has the paper's own controller.
    #[serde(default)]
    pub paper: bool,
}

impl Conditions {
    /// Sets the controller of a scenario.
    pub(super) fn control(self, scenario: Scenario) -> Scenario {
        if self.paper { scenario.as_in_paper() } else { scenario }
    }
}
