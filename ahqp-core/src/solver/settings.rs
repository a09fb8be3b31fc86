//! Settings of the solver.

use crate::error::Error;

/// Effort and tolerances of the solver.
///
/// All tolerances are relative to the sizes of the rows, bounds and gradients involved, so that
/// they do not depend on units. They are at most 1e-4. Only rows without coefficients are judged in
/// their own unit.
///
/// ```
/// use ahqp_core::Settings;
///
/// let settings = Settings { max_iterations: 50, ..Settings::default() };
/// assert!(settings.validate().is_ok());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Largest number of iterations of one solve, at least 1 \[-\]. Iterations are rounds of
    /// repairing the prediction, and steps of searches over all levels. Rounding may let a search
    /// cycle, which ends here. Default 1000.
    pub max_iterations: usize,
    /// Largest violation with which a constraint holds \[-\]. It is relative to the size of the
    /// constraint's terms and of its nearer bound at the solution. Default 1e-10. A row without
    /// coefficients has the size one beside its bound. The rounding of the steps, 1e-14 of ‖a‖ times
    /// the longest x on the way, does not count as a violation.
    pub feasibility_tolerance: f64,
    /// A row depends on others if they leave less than this fraction of its norm \[-\]. Default
    /// 1e-10.
    pub rank_tolerance: f64,
    /// Upper bound of what counts as rounding of a multiplier, relative to the level's forces
    /// \[-\].
    ///
    /// A row is freed if its multiplier has the wrong sign and exceeds the rounding of its sum. If
    /// rows nearly depend on each other, the computed rounding is much too large, and this bound
    /// counts. In the choice of least norm it is relative to ‖x‖. Default 1e-10.
    pub optimality_tolerance: f64,
    /// Start of a solve. Default: the active set of the solve before.
    pub warm_start: WarmStart,
    /// Method by which a level keeps what the levels above decided. Default: elimination.
    pub stacking: Stacking,
}

/// Start of a solve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum WarmStart {
    /// The active set at the end of the previous solve. If rows come and go, the usual activity of
    /// each row.
    #[default]
    PreviousActiveSet,
    /// An empty active set.
    Cold,
}

/// Method by which later levels keep the optimum of a level.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Stacking {
    /// Directions that a level decided are eliminated. Nothing is allocated.
    #[default]
    Elimination,
    /// Equalities A_k χ = A_k χ*_k are stacked, as in the paper (Sec. III-A), and each level is
    /// solved by Clarabel in their nullspace ([`solve_reference`](crate::solve_reference)).
    ///
    /// It allocates, ignores [`Budget`](crate::Budget)s and starts, and leaves no certificate. A
    /// solve takes as many iterations as there are levels.
    #[cfg(feature = "reference")]
    Equalities,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            max_iterations: 1000,
            feasibility_tolerance: 1e-10,
            rank_tolerance: 1e-10,
            optimality_tolerance: 1e-10,
            warm_start: WarmStart::default(),
            stacking: Stacking::default(),
        }
    }
}

/// Larger tolerances would make the solution depend on the start of a solve.
const LARGEST_TOLERANCE: f64 = 1e-4;

impl Settings {
    /// Returns true if tolerances and method are the same.
    pub(crate) fn has_tolerances_of(&self, other: &Self) -> bool {
        let Self { max_iterations, warm_start, .. } = *other;
        Self { max_iterations, warm_start, ..*self } == *other
    }

    /// Checks the ranges.
    ///
    /// # Errors
    /// [`Error::Value`] names the first setting that is out of its range.
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
