//! Settings of the stack.

use whole_body::tasks::{Feedback, PostureTask};

use crate::error::{Error, check_settings, check_size};

/// The posture task, which decides motions that no other level determines.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct PostureSettings {
    /// Preferred configuration \[m or rad\]; joints without a gain ignore it.
    pub configuration: Vec<f64>,
    /// Rate at which a joint returns to it \[1/s\]; zero for joints that only rest.
    pub gain: Vec<f64>,
    /// Weight of a joint relative to the others \[-\].
    pub weight: Vec<f64>,
}

/// The levels of the stack besides those of safety.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Levels {
    /// Return of joints into their limits, gentle motion of the base, inverse kinematics, workspace, goal and posture.
    #[default]
    Extended,
    /// The paper's three (Sec. III-E): inverse kinematics, workspace and goal. The solver takes the least norm of what
    /// they leave.
    Paper,
}

impl PostureSettings {
    pub(crate) fn check(&self, joints: usize) -> Result<(), Error> {
        for (what, values) in [
            ("posture.configuration", &self.configuration),
            ("posture.gain", &self.gain),
            ("posture.weight", &self.weight),
        ] {
            check_size(what, values, joints)?;
            check_settings(values.iter().map(|&value| (what, value)), "finite", f64::is_finite)?;
        }
        let gains = self.gain.iter().map(|&gain| ("posture.gain", gain));
        let weights = self.weight.iter().map(|&weight| ("posture.weight", weight));
        check_settings(gains.chain(weights), "not negative", |value| value >= 0.0)
    }

    /// wᵢ q̇ᵢ = wᵢ gainᵢ (goalᵢ − qᵢ).
    pub(crate) fn task(&self) -> Result<PostureTask, Error> {
        let squares: Vec<f64> = self.weight.iter().map(|weight| weight * weight).collect();
        // The joints' limits alone decide how fast they return to the goal.
        let feedback = Feedback { deceleration: f64::INFINITY, ..Feedback::JOINT };
        let mut task = PostureTask::new()
            .with_feedback(feedback)
            .with_gains(&self.gain)
            .with_weights(&squares);
        task.set_target(&self.configuration)?;
        Ok(task)
    }
}
