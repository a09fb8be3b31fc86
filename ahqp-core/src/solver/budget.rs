//! Budgets of a solve.

use std::time::{Duration, Instant};

use crate::problem::ids::LevelId;
use crate::solver::status::Status;

/// Number of iterations between two checks of the clock.
const LOOK_EVERY: usize = 8;

/// Budget of one solve, in addition to
/// [`Settings::max_iterations`](crate::Settings::max_iterations). The default has no limits.
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
    /// Largest number of iterations. The settings' number counts if it is smaller.
    pub iterations: Option<usize>,
    /// Largest wall-clock time, checked every eighth iteration. Every solve makes at least that
    /// many iterations. It exceeds its time by at most as many, plus loading the data and fixing a
    /// level.
    #[cfg_attr(
        feature = "serde",
        serde(default, with = "crate::solver::seconds"),
        schemars(with = "Option<f64>")
    )]
    pub time: Option<Duration>,
}

impl Budget {
    /// Creates a budget of iterations without a time limit.
    pub fn iterations(iterations: usize) -> Self {
        Self { iterations: Some(iterations), time: None }
    }

    /// Creates a budget of time without a limit of iterations.
    pub fn time(time: Duration) -> Self {
        Self { iterations: None, time: Some(time) }
    }
}

/// Remaining part of a budget.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RemainingBudget {
    iterations: usize,
    deadline: Option<Instant>,
    is_late: bool,
}

impl RemainingBudget {
    /// Starts the budget of a solve that begins now.
    pub(crate) fn new(budget: Budget, max_iterations: usize) -> Self {
        let iterations = budget.iterations.map_or(max_iterations, |most| most.min(max_iterations));
        let deadline = budget.time.and_then(|time| Instant::now().checked_add(time));
        Self { iterations, deadline, is_late: false }
    }

    /// Iterations left after `spent`.
    pub(crate) fn left(&self, spent: usize) -> usize {
        self.iterations.saturating_sub(spent)
    }

    /// Returns true if nothing is left after this number of iterations.
    pub(crate) fn is_spent(&mut self, iterations: usize) -> bool {
        if let Some(deadline) = self.deadline
            && iterations > 0
            && iterations.is_multiple_of(LOOK_EVERY)
        {
            self.is_late |= Instant::now() >= deadline;
        }
        self.is_late || iterations >= self.iterations
    }

    /// Returns the status of a solve whose budget ran out.
    pub(crate) fn status(&self, level: Option<LevelId>) -> Status {
        if self.is_late { Status::TimeLimit { level } } else { Status::IterationLimit { level } }
    }
}
