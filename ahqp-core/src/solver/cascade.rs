//! The cascade of levels, from the first to the last.

use std::ops::Range;

use super::Solver;
use super::active_set::{End, Goal};
use super::status::Status;
use crate::error::Error;
use crate::problem::ids::LevelId;
use crate::problem::source::Names;

/// Ending of a level that did not fail.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum LevelEnd {
    Solved,
    OutOfBudget,
    GaveUp,
}

impl Solver {
    /// Makes each level feasible, minimises it and fixes it. None if a search gives up.
    pub(super) fn search_levels(&mut self, levels: usize) -> Result<Option<Status>, Error> {
        self.set.begin_search(&self.solution.x);
        for level in 0..=levels {
            let (end, id) = match level {
                _ if level == levels => (self.choose_least_norm(levels), None),
                _ => (self.solve_level(level)?, Some(LevelId::new(level))),
            };
            match end {
                LevelEnd::Solved => {}
                LevelEnd::OutOfBudget => return Ok(Some(self.set.remaining.status(id))),
                LevelEnd::GaveUp => return Ok(None),
            }
        }
        Ok(Some(Status::Solved))
    }

    fn solve_level(&mut self, level: usize) -> Result<LevelEnd, Error> {
        let rows = &self.set.data.levels[level];
        let (constraints, objective) = (rows.constraints.clone(), rows.used_objective());
        let is_minimised = !objective.is_empty() || rows.has_linear;
        self.set.open_held(level);
        let feasible = self.make_feasible(level, constraints.clone())?;
        if feasible != LevelEnd::Solved {
            return Ok(feasible);
        }
        self.set.place_hard(level, constraints);
        if self.set.is_decided() {
            self.set.classify_rows(objective);
            return Ok(LevelEnd::Solved);
        }
        let goal = is_minimised.then(|| Goal::Rows(objective.clone()));
        if let Some(goal) = &goal {
            self.set.place_soft(level, objective);
            match self.set.search(goal) {
                End::Unbounded => return Err(unbounded(level)),
                End::OutOfBudget => return Ok(LevelEnd::OutOfBudget),
                End::GaveUp => return Ok(LevelEnd::GaveUp),
                End::Optimal => {}
            }
        }
        self.set.fix_level(goal.as_ref());
        Ok(LevelEnd::Solved)
    }

    /// Moves x to a point at which the new hard constraints of `level` hold, at no cost to the
    /// levels above. It minimises their violation.
    ///
    /// The values that a search sums up contain the rounding of all its steps. Rows that it leaves
    /// violated contradict each other only if a second search, which starts there from the data,
    /// leaves them violated too. A third one trusts coefficients that may be noise beside their row.
    fn make_feasible(&mut self, level: usize, rows: Range<usize>) -> Result<LevelEnd, Error> {
        if self.set.all_hold(rows.clone()) {
            return Ok(LevelEnd::Solved);
        }
        for is_last in [false, false, true] {
            self.set.place_soft(level, rows.clone());
            self.set.multipliers.trusts_coefficients = is_last;
            let end = self.set.search(&Goal::Rows(rows.clone()));
            self.set.multipliers.trusts_coefficients = false;
            match end {
                End::OutOfBudget => return Ok(LevelEnd::OutOfBudget),
                End::GaveUp => return Ok(LevelEnd::GaveUp),
                End::Unbounded => return Err(unbounded(level)),
                End::Optimal => {}
            }
            self.set.compute_values(rows.clone());
            let worst = self.set.most_violated(rows.clone());
            if let Some(worst) = worst.filter(|_| is_last) {
                return Err(self.infeasible(level, rows, worst));
            }
            self.set.remove_soft(rows.clone());
            if worst.is_none() {
                break;
            }
        }
        Ok(LevelEnd::Solved)
    }

    /// Creates the error for hard rows that cannot hold together, with `worst` among them. Lists
    /// the conflict.
    fn infeasible(&mut self, level: usize, rows: Range<usize>, worst: usize) -> Error {
        let violated = rows.clone().filter(|&id| self.set.relative_violation(id) > 1.0);
        self.conflict.extend(violated.map(|id| self.set.data.sources[id]));
        let size = |id: usize| self.set.violation(id).abs() * self.set.data.norm(id);
        let threshold = self.settings.optimality_tolerance * rows.map(size).sum::<f64>();
        let pushing = self.conflict.len();
        self.set.add_conflict_multipliers(threshold, &mut self.conflict);
        self.conflict[pushing..].sort_unstable();
        Error::Infeasible {
            level: LevelId::new(level),
            worst: self.set.data.sources[worst],
            violation: self.set.violation(worst).abs() / self.set.data.scale(worst),
            members: self.conflict.len(),
            names: Names::default(),
        }
    }

    /// Chooses the point of least norm among the optima of all levels.
    fn choose_least_norm(&mut self, levels: usize) -> LevelEnd {
        if !self.set.is_decided() {
            self.set.open_held(levels);
            return match self.set.search(&Goal::Norm) {
                End::OutOfBudget => LevelEnd::OutOfBudget,
                End::GaveUp => LevelEnd::GaveUp,
                End::Optimal | End::Unbounded => LevelEnd::Solved,
            };
        }
        LevelEnd::Solved
    }
}

fn unbounded(level: usize) -> Error {
    Error::Unbounded { level: LevelId::new(level), names: Names::default() }
}
