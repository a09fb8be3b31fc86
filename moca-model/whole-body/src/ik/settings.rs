//! The few parameters of the inverse kinematics.

use ahqp_core::{Budget, Settings};

use crate::error::Error;

/// How tasks and limits become velocities.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IkSettings {
    /// Of the solver.
    pub solver: Settings,
    /// What one step may cost. Default: the solver's iterations, in any time.
    pub budget: Budget,
    /// Singular value below which speeds are bounded, from 0 (never) to 1 \[-\]. It is one of the
    /// rows of a level, scaled to norm one and without what the levels above decide: 1 where the
    /// rows are at right angles to each other and to those above, 0 where one cannot be met.
    /// Default 0.1.
    pub singularity_threshold: f64,
}

impl Default for IkSettings {
    fn default() -> Self {
        Self { solver: Settings::default(), budget: Budget::default(), singularity_threshold: 0.1 }
    }
}

impl IkSettings {
    /// Checks the ranges.
    ///
    /// # Errors
    /// [`Error::Value`], and [`Error::Hierarchy`] for a setting of the solver.
    pub fn validate(&self) -> Result<(), Error> {
        self.solver.validate()?;
        let value = self.singularity_threshold;
        if (0.0..1.0).contains(&value) {
            return Ok(());
        }
        let (what, expected) = ("the threshold of singularities", "from 0 to below 1");
        Err(Error::value(what, value, expected))
    }
}
