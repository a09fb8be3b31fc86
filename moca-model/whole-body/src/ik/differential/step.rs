//! The result of a step.

use std::ops::Range;

use ahqp_core::{Rows, Status};

use super::Ik;
use crate::error::Error;
use crate::limits::joint_intervals::Last;
use crate::limits::limit_kind::{End, LimitKind};
use crate::stack::task_level::TaskId;

/// The velocity of one step, and what limited it.
///
/// It borrows the [`Ik`]; reading it allocates nothing.
#[derive(Debug, Clone, Copy)]
#[must_use = "a step gives velocities for the robot"]
pub struct Step<'a> {
    pub(super) ik: &'a Ik,
}

/// A level of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LevelReport<'a> {
    /// Name of the level.
    pub name: &'a str,
    /// √(Σ wᵢ dᵢ²), where dᵢ is the distance of row i to its range. Zero where all tasks get the velocities that they
    /// ask for; near singular configurations tasks may get less. Zero for quadratics.
    pub slack: f64,
}

/// A joint that a limit stops from moving otherwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ActiveLimit<'a> {
    /// The entry of q̇.
    pub entry: usize,
    /// The joint whose limit it is: that of the entry, or one that mimics it.
    pub name: &'a str,
    /// Kind of the limit.
    pub kind: LimitKind,
    /// End of the allowed interval at which the velocity is.
    pub end: End,
}

/// A row of a limit, or of a task that asks for a range, that is at its bound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ActiveRow<'a> {
    /// The level; `limits` for a hard limit.
    pub level: &'a str,
    /// The task or limit.
    pub task: &'a str,
    /// The row, counted from 0 within the level.
    pub row: usize,
    /// The bound.
    pub end: End,
}

impl<'a> Step<'a> {
    /// q̇ for the next period \[rad/s, m/s\].
    pub fn velocity(&self) -> &'a [f64] {
        self.ik.velocity()
    }

    /// (q̇ − the last q̇) / period \[rad/s², m/s²\].
    pub fn acceleration(&self) -> &'a [f64] {
        self.ik.acceleration()
    }

    /// Moves q \[rad or m\] along the velocity for the period of the step.
    ///
    /// # Errors
    /// Those of [`Model::integrate`](crate::Model::integrate).
    pub fn integrate(&self, q: &mut [f64]) -> Result<(), Error> {
        self.ik.model().integrate(q, &self.ik.displacement)
    }

    /// The time for which the velocity holds \[s\].
    pub fn period(&self) -> f64 {
        self.ik.period
    }

    /// Status: solved if every level is at its optimum. Otherwise the budget ran out, limits still hold, and the next step
    /// continues from there.
    pub fn status(&self) -> Status {
        self.ik.stack.solution().map_or(Status::Solved, ahqp_core::Solution::status)
    }

    /// Iterations of the solver.
    pub fn iterations(&self) -> usize {
        self.ik.stack.solution().map_or(0, ahqp_core::Solution::iterations)
    }

    /// Variables: q̇, then those of [`IkBuilder::variables`](crate::ik::IkBuilder::variables).
    pub fn variables(&self) -> &'a [f64] {
        self.ik.stack.solution().map_or(&[], ahqp_core::Solution::best)
    }

    /// The levels of tasks, highest priority first.
    pub fn levels(&self) -> impl Iterator<Item = LevelReport<'a>> + use<'a> {
        let (ik, x) = (self.ik, self.variables());
        let levels = ik.stack.levels().enumerate().skip(usize::from(ik.has_limits));
        levels.map(move |(index, (tasks, level))| {
            let rows = ik.asked_rows(index, level);
            let own = 0..tasks.row_count();
            let slack = rows.map_or(0.0, |rows| violation(rows, own, x));
            LevelReport { name: &tasks.name, slack }
        })
    }

    /// √(Σ wᵢ dᵢ²) of one task; see [`LevelReport::slack`].
    ///
    /// # Errors
    /// [`Error::UnknownTask`].
    pub fn slack<T>(&self, task: TaskId<T>) -> Result<f64, Error> {
        let mut levels = self.ik.stack.levels().enumerate();
        let found = levels.find_map(|(index, (tasks, level))| {
            let range = tasks.rows_of(task.number)?;
            Some((self.ik.asked_rows(index, level)?, range))
        });
        let (rows, range) = found.ok_or(Error::UnknownTask)?;
        Ok(violation(rows, range, self.variables()))
    }

    /// The joints whose velocities are at an end of what their limits allow, each with the limit.
    pub fn active_limits(&self) -> impl Iterator<Item = ActiveLimit<'a>> + use<'a> {
        let ik = self.ik;
        let entries = ik.velocity().iter().zip(&ik.intervals.now).enumerate();
        entries.filter_map(move |(entry, (&velocity, interval))| {
            let near = |bound: f64| is_near(velocity, bound);
            let end = if near(interval.upper) {
                End::Upper
            } else if near(interval.lower) {
                End::Lower
            } else {
                return None;
            };
            let acceleration = ik.last_acceleration[entry];
            let last =
                Last { velocity: velocity - ik.acceleration[entry] * ik.period, acceleration };
            let kind = ik.intervals.kind(entry, end, last, ik.period);
            let follower = ik.model.limiting_follower(entry, kind, end);
            let name = follower.unwrap_or(&ik.stack.names()[entry]);
            Some(ActiveLimit { entry, name, kind, end })
        })
    }

    /// The rows of limits and ranges that are at a bound.
    pub fn active_rows(&self) -> impl Iterator<Item = ActiveRow<'a>> + use<'a> {
        let x = self.variables();
        let levels = self.ik.stack.levels();
        let rows = levels.flat_map(|(tasks, level)| {
            let named = tasks.named_rows(level);
            named.map(move |(rows, count, names)| (&*tasks.name, rows, count, names))
        });
        rows.flat_map(move |(level, rows, count, names)| {
            rows.iter().enumerate().take(count).filter_map(
                move |(row, (coefficients, lower, upper))| {
                    let value: f64 = coefficients.iter().zip(x).map(|(a, x)| a * x).sum();
                    let near = |bound: f64| is_near(value, bound);
                    let end = match (near(lower), near(upper)) {
                        _ if lower == upper => return None,
                        (_, true) => End::Upper,
                        (true, _) => End::Lower,
                        _ => return None,
                    };
                    Some(ActiveRow { level, task: names(row), row, end })
                },
            )
        })
    }
}

/// True if a value is at a bound, up to rounding. An infinite bound is none.
fn is_near(value: f64, bound: f64) -> bool {
    bound.is_finite() && (value - bound).abs() <= 1e-9 * (1e-3 + bound.abs())
}

/// √(Σ wᵢ dᵢ²) of some rows, where dᵢ is the distance of row i to its range.
fn violation(rows: &Rows, range: Range<usize>, x: &[f64]) -> f64 {
    let squares = range.filter_map(|index| {
        let (lower, upper) = (rows.lower().get(index)?, rows.upper().get(index)?);
        let value: f64 = rows.row(index)?.iter().zip(x).map(|(a, x)| a * x).sum();
        let distance = (lower - value).max(value - upper).max(0.0);
        Some(rows.weight(index) * distance * distance)
    });
    squares.sum::<f64>().sqrt()
}
