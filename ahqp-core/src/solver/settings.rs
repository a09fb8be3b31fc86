//! The solver's few parameters.

use crate::error::Error;

/// How hard the solver tries and what it calls zero. All tolerances are relative to the sizes
/// of the rows, bounds and gradients at hand, so that they do not depend on units, and at most 1e-4.
/// Only rows without coefficients are judged in their own unit.
///
/// ```
/// use ahqp_core::Settings;
///
/// let settings = Settings { max_iterations: 50, ..Settings::default() };
/// assert!(settings.validate().is_ok());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Iterations of one solve, at least 1 \[-\]: rounds of repairing the prediction, and steps
    /// of searches over all levels. Default 1000.
    pub max_iterations: usize,
    /// A constraint holds when it is violated by less than this, relative to the size of its terms
    /// and of its nearer bound at the solution \[-\]. Default 1e-10. A row without coefficients has the
    /// size one beside its bound. What the rounding of x explains, 1e-14 of ‖a‖‖x‖, counts as none.
    pub feasibility_tolerance: f64,
    /// A row depends on others when what they leave of it is below this fraction of its norm
    /// \[-\]. Default 1e-10.
    pub rank_tolerance: f64,
    /// A multiplier of the wrong sign frees its row when it exceeds the rounding of the sum that it
    /// comes from. Where rows nearly depend on each other that bound says little: rounding then counts
    /// as at most this part of the level's forces \[-\]. In the choice of least norm it is relative
    /// to ‖x‖. Default 1e-10.
    pub optimality_tolerance: f64,
    /// Where a solve starts. Default: from the active set of the one before.
    pub warm_start: WarmStart,
}

/// Where a solve starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum WarmStart {
    /// From the active set at which the previous solve ended, or, where rows come and go, from what
    /// each has done most of the time.
    #[default]
    PreviousActiveSet,
    /// From nothing.
    Cold,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            max_iterations: 1000,
            feasibility_tolerance: 1e-10,
            rank_tolerance: 1e-10,
            optimality_tolerance: 1e-10,
            warm_start: WarmStart::default(),
        }
    }
}

/// With larger tolerances the answer depends on where a solve starts.
const LARGEST_TOLERANCE: f64 = 1e-4;

impl Settings {
    /// Returns true if the tolerances are the same.
    pub(crate) fn has_tolerances_of(&self, other: &Self) -> bool {
        let Self { max_iterations, warm_start, .. } = *other;
        Self { max_iterations, warm_start, ..*self } == *other
    }

    /// Checks the ranges.
    ///
    /// # Errors
    /// [`Error::Value`] names the first that is out of its range.
    pub fn validate(&self) -> Result<(), Error> {
        if self.max_iterations == 0 {
            return Err(Error::value("max_iterations", 0.0, "at least 1"));
        }
        for (name, value) in [
            ("feasibility_tolerance", self.feasibility_tolerance),
            ("rank_tolerance", self.rank_tolerance),
            ("optimality_tolerance", self.optimality_tolerance),
        ] {
            if !(value > 0.0 && value <= LARGEST_TOLERANCE) {
                let expected = "above 0 and at most 1e-4";
                return Err(Error::value(name, value, expected));
            }
        }
        Ok(())
    }
}
