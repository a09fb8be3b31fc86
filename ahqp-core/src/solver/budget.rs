//! How much a solve may cost.

use std::time::{Duration, Instant};

use crate::problem::ids::LevelId;
use crate::solver::status::Status;

/// Iterations between two looks at the clock.
const LOOK_EVERY: usize = 8;

/// What one solve may cost, beside [`Settings::max_iterations`](crate::Settings::max_iterations).
/// The default has no limits of its own.
///
/// ```
/// use ahqp_core::Budget;
/// use std::time::Duration;
///
/// let budget = Budget { time: Some(Duration::from_micros(400)), ..Budget::iterations(200) };
/// assert_eq!(budget.iterations, Some(200));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Budget {
    /// Iterations; the settings' count where that is less.
    pub iterations: Option<usize>,
    /// Wall-clock time, looked at every eighth iteration: every solve makes that many, and exceeds
    /// its time by at most as many and what loading the data and fixing a level take.
    #[cfg_attr(
        feature = "serde",
        serde(default, with = "crate::solver::seconds"),
        schemars(with = "Option<f64>")
    )]
    pub time: Option<Duration>,
}

impl Budget {
    /// So many iterations, in any time.
    pub fn iterations(iterations: usize) -> Self {
        Self { iterations: Some(iterations), time: None }
    }

    /// So much time.
    pub fn time(time: Duration) -> Self {
        Self { iterations: None, time: Some(time) }
    }
}

/// What is left of a budget.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Allowance {
    iterations: usize,
    deadline: Option<Instant>,
    is_late: bool,
}

impl Allowance {
    /// The budget of a solve that begins now.
    pub(crate) fn new(budget: Budget, max_iterations: usize) -> Self {
        let iterations = budget.iterations.map_or(max_iterations, |most| most.min(max_iterations));
        let deadline = budget.time.and_then(|time| Instant::now().checked_add(time));
        Self { iterations, deadline, is_late: false }
    }

    /// Iterations left after `spent`.
    pub(crate) fn left(&self, spent: usize) -> usize {
        self.iterations.saturating_sub(spent)
    }

    /// Returns true if nothing is left after so many iterations.
    pub(crate) fn is_spent(&mut self, iterations: usize) -> bool {
        if let Some(deadline) = self.deadline
            && iterations > 0
            && iterations.is_multiple_of(LOOK_EVERY)
        {
            self.is_late |= Instant::now() >= deadline;
        }
        self.is_late || iterations >= self.iterations
    }

    /// How a solve ended that nothing was left for.
    pub(crate) fn status(&self, level: Option<LevelId>) -> Status {
        if self.is_late { Status::TimeLimit { level } } else { Status::IterationLimit { level } }
    }
}
