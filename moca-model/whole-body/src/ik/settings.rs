//! Parameters of the inverse kinematics.

use ahqp_core::{Budget, Settings};

use crate::error::Error;

/// Settings of the inverse kinematics.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IkSettings {
    /// Settings of the solver.
    pub solver: Settings,
    /// Budget of one step. The default limits the solver's iterations but not its time.
    pub budget: Budget,
    /// Singular value below which speeds are bounded, from 0 (never) to 1 \[-\]. Default 0.1.
    ///
    /// The rows of a level are scaled to norm one and projected on what the levels above leave. The singular value is 1
    /// where the rows are orthogonal to each other and to those above, and 0 where a row cannot be met.
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
