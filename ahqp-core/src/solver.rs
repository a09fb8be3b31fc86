//! The loop over the levels.

use crate::active_set::{ActiveSet, End, Goal, RowState};
use crate::error::Error;
use crate::hierarchy::{ConstraintSource, Hierarchy};
use crate::settings::{Settings, WarmStart};
use crate::solution::{Solution, Status};
use crate::table::RowTable;
use crate::vector::norm;

/// A multiplier this many times above the noise marks its row as active at every optimum.
const STRONGLY_ACTIVE: f64 = 1e3;

/// Solves hierarchies of one shape, without allocation after construction.
///
/// Level by level: make the new hard constraints hold, minimise the objective inside what the
/// levels above left free, then fix the directions that the level decided. The equality
/// Aₖχ = Aₖχ*ₖ of the paper (after its eq. 1) thereby holds by elimination, and the problems
/// shrink from level to level.
///
/// See [`Hierarchy`] for an example.
#[derive(Debug, Clone)]
pub struct Solver {
    set: ActiveSet,
    settings: Settings,
    solution: Solution,
    /// The working set at the end of each level, and of the final choice of least norm.
    guesses: Vec<Vec<(usize, RowState)>>,
    warm: bool,
    conflict: Vec<ConstraintSource>,
}

/// How a level ended, if it did not fail.
enum LevelEnd {
    Solved,
    OutOfIterations,
}

impl Solver {
    /// Sizes a solver for hierarchies of this shape.
    ///
    /// # Errors
    /// [`Error::Setting`] for a setting out of range.
    pub fn new(hierarchy: &Hierarchy, settings: Settings) -> Result<Self, Error> {
        settings.validate()?;
        let table = RowTable::new(hierarchy);
        let (n, count) = (table.n, table.len());
        let levels = hierarchy.levels().len();
        Ok(Self {
            solution: Solution {
                x: vec![0.0; n],
                status: Status::Solved,
                iterations: 0,
                violations: vec![0.0; levels],
            },
            // Not `vec![…; levels + 1]`: clones of an empty vector have no capacity.
            guesses: (0..=levels).map(|_| Vec::with_capacity(count + n)).collect(),
            warm: false,
            conflict: Vec::with_capacity(count),
            set: ActiveSet::new(table, settings),
            settings,
        })
    }

    /// Forgets the previous active set: the next solve starts from nothing.
    pub fn forget(&mut self) {
        self.warm = false;
    }

    /// Constraints that cannot hold together with what the levels above hold, after
    /// [`Error::Infeasible`]; empty otherwise.
    pub fn conflict(&self) -> &[ConstraintSource] {
        &self.conflict
    }

    /// Solves `hierarchy`, of the shape given at construction.
    ///
    /// # Errors
    /// Data that make no problem ([`Error::NotFinite`], [`Error::EmptyRange`],
    /// [`Error::AsymmetricHessian`], [`Error::IndefiniteHessian`], [`Error::ShapeChanged`]), or
    /// a problem that has no solution ([`Error::Infeasible`], [`Error::Unbounded`]).
    pub fn solve(&mut self, hierarchy: &Hierarchy) -> Result<&Solution, Error> {
        let warm = self.warm && self.settings.warm_start == WarmStart::PreviousActiveSet;
        self.warm = false;
        self.conflict.clear();
        self.set.table.load(hierarchy)?;
        self.set.reset();
        let levels = hierarchy.levels().len();
        let mut status = Status::Solved;
        for level in 0..levels {
            if let LevelEnd::OutOfIterations = self.solve_level(level, warm)? {
                status = Status::IterationLimit { level };
                break;
            }
        }
        if status == Status::Solved
            && let LevelEnd::OutOfIterations = self.choose_least_norm(levels, warm)
        {
            status = Status::IterationLimit { level: levels };
        }
        self.warm = status == Status::Solved;
        self.read_out(status);
        Ok(&self.solution)
    }

    fn solve_level(&mut self, level: usize, warm: bool) -> Result<LevelEnd, Error> {
        let entry = &self.set.table.levels[level];
        let (constraints, objective) = (entry.constraints.clone(), entry.used_objective());
        let has_linear = entry.has_linear;
        let goal = (!objective.is_empty() || has_linear).then(|| Goal::Rows {
            rows: objective.clone(),
            linear_of: has_linear.then_some(level),
        });
        let guessed = warm && self.set.try_guess(&self.guesses[level], goal.as_ref(), constraints);
        if !guessed {
            if let LevelEnd::OutOfIterations = self.make_feasible(level)? {
                return Ok(LevelEnd::OutOfIterations);
            }
            self.set.place_soft(objective);
        }
        let end = match &goal {
            Some(goal) => self.set.search(goal, guessed),
            None => End::Optimal,
        };
        match end {
            End::Unbounded => return Err(Error::Unbounded { level }),
            End::OutOfIterations => return Ok(LevelEnd::OutOfIterations),
            End::Optimal => {}
        }
        self.remember(level, goal.as_ref());
        self.settle(level, goal.as_ref());
        Ok(LevelEnd::Solved)
    }

    /// Brings x to where the new hard constraints of `level` hold, at no cost to the levels
    /// above, by minimising their violation.
    fn make_feasible(&mut self, level: usize) -> Result<LevelEnd, Error> {
        let rows = self.set.table.levels[level].constraints.clone();
        self.set.place_soft(rows.clone());
        let x_norm = norm(&self.set.x);
        let holds =
            rows.clone().all(|id| self.set.violation(id).abs() <= self.set.tolerance(id, x_norm));
        if !holds {
            self.solution.x.copy_from_slice(&self.set.x);
            let goal = Goal::Rows { rows: rows.clone(), linear_of: None };
            match self.set.search(&goal, false) {
                End::OutOfIterations => {
                    self.set.x.copy_from_slice(&self.solution.x);
                    return Ok(LevelEnd::OutOfIterations);
                }
                End::Unbounded => return Err(Error::Unbounded { level }),
                End::Optimal => self.expect_feasible(level, &goal)?,
            }
        }
        self.set.place_hard(rows);
        Ok(LevelEnd::Solved)
    }

    fn expect_feasible(&mut self, level: usize, goal: &Goal) -> Result<(), Error> {
        let rows = self.set.table.levels[level].constraints.clone();
        let x_norm = norm(&self.set.x);
        let excess =
            |set: &ActiveSet, id: usize| set.violation(id).abs() / set.tolerance(id, x_norm);
        let Some(worst) = rows
            .clone()
            .max_by(|&i, &j| excess(&self.set, i).total_cmp(&excess(&self.set, j)))
            .filter(|&id| excess(&self.set, id) > 1.0)
        else {
            return Ok(());
        };
        let threshold = self.set.refresh_multipliers(goal);
        for id in rows {
            if excess(&self.set, id) > 1.0 {
                self.conflict.push(self.set.table.sources[id]);
            }
        }
        for position in 0..self.set.basis.active().len() {
            if self.set.is_strongly_active(position, threshold) {
                let id = self.set.basis.active()[position];
                self.conflict.push(self.set.table.sources[id]);
            }
        }
        Err(Error::Infeasible {
            level,
            worst: self.set.table.sources[worst],
            violation: self.set.violation(worst).abs(),
            members: self.conflict.len(),
        })
    }

    /// Among the optima of all levels, the one of least norm.
    fn choose_least_norm(&mut self, levels: usize, warm: bool) -> LevelEnd {
        if self.set.basis.free_count() + self.set.basis.active().len() == 0 {
            self.guesses[levels].clear();
            return LevelEnd::Solved;
        }
        let guessed = warm && self.set.try_guess(&self.guesses[levels], Some(&Goal::Norm), 0..0);
        if self.set.search(&Goal::Norm, guessed) == End::OutOfIterations {
            return LevelEnd::OutOfIterations;
        }
        self.remember(levels, None);
        LevelEnd::Solved
    }

    /// Keeps the working set for the next solve.
    fn remember(&mut self, level: usize, goal: Option<&Goal>) {
        let guess = &mut self.guesses[level];
        guess.clear();
        guess.extend(self.set.basis.active().iter().map(|&id| (id, self.set.state[id])));
        if let Some(Goal::Rows { rows, .. }) = goal {
            let pulled =
                |id: &usize| matches!(self.set.state[*id], RowState::Lower | RowState::Upper);
            guess.extend(rows.clone().filter(pulled).map(|id| (id, self.set.state[id])));
        }
    }

    /// Fixes what the level decided: rows of its objective keep their values (those within
    /// their ranges stay within), and hard rows with a multiplier stay at their bounds.
    fn settle(&mut self, level: usize, goal: Option<&Goal>) {
        let set = &mut self.set;
        let threshold = match goal {
            Some(goal) => STRONGLY_ACTIVE * set.refresh_multipliers(goal),
            None => f64::INFINITY,
        };
        let count = set.basis.active().len();
        let mut weak = 0;
        // Strongly active rows first, the others behind them, in place.
        let guess = &mut self.guesses[level];
        let pulled = guess.len() - count;
        for position in 0..count {
            let id = set.basis.active()[position];
            if set.is_strongly_active(position, threshold) {
                set.state[id] = RowState::Fixed;
            } else {
                guess.push((id, set.state[id]));
                weak += 1;
            }
        }
        set.basis.clear_active();
        for &(id, _) in &guess[..count] {
            if set.state[id] == RowState::Fixed {
                set.basis.fix(set.table.row(id), self.settings.rank_tolerance);
            }
        }
        set.hard.retain(|&id| set.state[id] != RowState::Fixed);
        if let Some(Goal::Rows { rows, linear_of }) = goal {
            set.fix_objective(rows.clone(), *linear_of);
        }
        for &(id, state) in &guess[count + pulled..] {
            set.state[id] = RowState::Inside;
            set.activate(id, state);
        }
        guess.truncate(guess.len() - weak);
    }

    fn read_out(&mut self, status: Status) {
        let table = &self.set.table;
        self.solution.status = status;
        self.solution.iterations = self.set.iterations;
        for (i, (to, &from)) in self.solution.x.iter_mut().zip(&self.set.x).enumerate() {
            *to = from.clamp(table.lower[i], table.upper[i]);
        }
        for (violation, level) in self.solution.violations.iter_mut().zip(&table.levels) {
            *violation = 0.0;
            if !level.quadratic {
                let squares: f64 = level
                    .objective
                    .clone()
                    .map(|id| {
                        let value = table.row(id).dot(&self.solution.x);
                        (value - value.clamp(table.lower[id], table.upper[id])).powi(2)
                    })
                    .sum();
                *violation = squares.sqrt();
            }
        }
    }
}
