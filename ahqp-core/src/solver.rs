//! The loop over the levels.

pub(crate) mod active_set;
mod basis;
pub(crate) mod data;
pub(crate) mod factorisation;
mod habits;
mod least_squares;
mod pulled;
mod quadratic_factor;
mod search;
pub(crate) mod settings;
mod settle;
pub(crate) mod solution;
pub(crate) mod tolerances;
pub(crate) mod verification;

use std::ops::Range;

use crate::certificate::Certificate;
use crate::certificate::multipliers::Proof;
use crate::error::Error;
use crate::linalg::list::List;
use crate::linalg::vector::norm;
use crate::problem::hierarchy::{ConstraintSource, Hierarchy};
use crate::solver::active_set::{ActiveSet, End, Goal, RowState};
use crate::solver::data::RowTable;
use crate::solver::habits::{Habits, JUMP};
use crate::solver::settings::{Settings, WarmStart};
use crate::solver::solution::{Solution, Status};
use crate::solver::verification::Verifier;

/// Rounds of mending an active set after which it is searched for.
const ROUNDS: usize = 14;

/// Rows up to which a guess at the active set may be wrong for the next to be mended.
const FEW: usize = 4;

/// Searches of one solve: each but the first begins where the one before ended, as that came from
/// so far away that little of x is left but rounding.
const PASSES: usize = 4;

/// How many times longer than the solution x may have been on the way.
const FAR_AWAY: f64 = 1e3;

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
    verifier: Verifier,
    habits: Habits,
    settings: Settings,
    solution: Solution,
    memory: Memory,
    /// Whether the active set has been guessed so well lately that asking the guess first pays.
    settled: bool,
    conflict: List<ConstraintSource>,
}

/// What is known of the last solve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Memory {
    Nothing,
    /// How far it came within its iterations.
    Part,
    Optimum,
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
            verifier: Verifier::new(&table, settings),
            habits: Habits::new(count, n),
            memory: Memory::Nothing,
            settled: true,
            conflict: List::with_capacity(count),
            set: ActiveSet::new(table, settings),
            settings,
        })
    }

    /// Forgets the previous active set: the next solve starts from nothing.
    pub fn forget(&mut self) {
        self.memory = Memory::Nothing;
    }

    /// What cannot hold together, after [`Error::Infeasible`]; empty otherwise: constraints,
    /// bounds, and rows of objectives above, at the values to which these levels brought them. A
    /// quadratic objective is there by rows of its factor.
    pub fn conflict(&self) -> &[ConstraintSource] {
        &self.conflict
    }

    /// The multipliers that prove the last solution optimal; [`Certificate::residuals`] checks
    /// them. Allocates: for debugging and tests, not for the control loop.
    ///
    /// # Errors
    /// Those of [`solve`](Self::solve) for data that make no problem; [`Error::NotSolved`] when
    /// the last solve did not end at the optimum, or was [forgotten](Self::forget);
    /// [`Error::DataChanged`] when `hierarchy` does not hold the data that were solved.
    pub fn certificate(&mut self, hierarchy: &Hierarchy) -> Result<Certificate, Error> {
        if self.memory != Memory::Optimum {
            return Err(Error::NotSolved);
        }
        self.set.table.expect_unchanged(hierarchy)?;
        let table = &mut self.set.table;
        self.verifier.fit(table);
        self.verifier.factorisation.factorise(
            table,
            &self.verifier.activity,
            self.settings.rank_tolerance,
        );
        let found = Proof::new(table, &mut self.verifier, &self.solution.x).levels()?;
        let levels = found
            .iter()
            .map(|multipliers| named(hierarchy, table, multipliers))
            .collect::<Result<_, _>>()?;
        let active = (0..table.len())
            .filter(|&id| self.verifier.activity[id].is_active())
            .map(|id| table.sources[id])
            .collect();
        Ok(Certificate { hierarchy: hierarchy.clone(), levels, active })
    }

    /// Solves `hierarchy`, of the shape given at construction.
    ///
    /// # Errors
    /// Data that make no problem ([`Error::NotFinite`], [`Error::TooLarge`], [`Error::EmptyRange`],
    /// [`Error::AsymmetricHessian`], [`Error::IndefiniteHessian`], [`Error::ShapeChanged`]), or
    /// a problem that has no solution ([`Error::Infeasible`], [`Error::Unbounded`]), or one beyond
    /// double precision ([`Error::Overflow`]).
    pub fn solve(&mut self, hierarchy: &Hierarchy) -> Result<&Solution, Error> {
        let memory = std::mem::replace(&mut self.memory, Memory::Nothing);
        self.conflict.clear();
        self.set.iterations = 0;
        self.set.table.load(hierarchy)?;
        let near = match (self.settings.warm_start, memory) {
            (WarmStart::PreviousActiveSet, Memory::Optimum) => {
                if self.mend() {
                    self.set.x.copy_from_slice(&self.verifier.factorisation.x);
                    self.finish(Status::Solved);
                    return Ok(&self.solution);
                }
                !self.verifier.far
            }
            (WarmStart::PreviousActiveSet, Memory::Part) => {
                self.verifier.fit(&self.set.table);
                self.set.hint.copy_from_slice(&self.verifier.activity);
                true
            }
            _ => {
                self.habits.forget();
                false
            }
        };
        if !near {
            self.set.hint.fill(RowState::Inside);
            self.solution.x.fill(0.0);
        }
        let status = self.search_levels(hierarchy.levels().len())?;
        let (changes, n) = (self.changes(), self.set.table.n);
        self.settled = !near || changes <= FEW || changes > n / JUMP;
        let status = self.search_again(status, hierarchy.levels().len())?;
        if !norm(&self.set.x).is_finite() {
            return Err(Error::Overflow);
        }
        self.finish(status);
        Ok(&self.solution)
    }

    fn finish(&mut self, status: Status) {
        if status == Status::Solved {
            self.memory = Memory::Optimum;
            self.habits.learn(&self.verifier.activity);
        } else {
            self.memory = Memory::Part;
        }
        self.read_out(status);
    }

    /// Searches again from where a search ended that came from far away: what rounding on the way
    /// left open is then near.
    fn search_again(&mut self, mut status: Status, levels: usize) -> Result<Status, Error> {
        for _ in 1..PASSES {
            let x_norm = norm(&self.set.x);
            let is_near = self.set.farthest <= FAR_AWAY * x_norm || x_norm == 0.0;
            if status != Status::Solved || is_near {
                break;
            }
            self.solution.x.copy_from_slice(&self.set.x);
            self.set.hint.fill(RowState::Inside);
            status = self.search_levels(levels)?;
        }
        Ok(status)
    }

    /// Mends what the last active sets make one expect, if that is likely to pay; whether it came
    /// to an end.
    fn mend(&mut self) -> bool {
        let guessed = self.habits.guess(&mut self.verifier.activity);
        if self.mend_activity() {
            return true;
        }
        if !guessed || !self.verifier.far {
            return false;
        }
        // What each row does most of the time need not go together.
        self.habits.repeat(&mut self.verifier.activity);
        self.mend_activity()
    }

    fn mend_activity(&mut self) -> bool {
        let Self { set, verifier, .. } = self;
        verifier.fit(&set.table);
        set.hint.copy_from_slice(&verifier.activity);
        if !self.settled {
            verifier.far = false;
            return false;
        }
        let left = self.settings.max_iterations.saturating_sub(set.iterations);
        let solved = verifier.solve(&set.table, ROUNDS.min(left));
        set.iterations += verifier.rounds;
        solved
    }

    /// How many rows are active where the search was not told so, or the other way round.
    fn changes(&self) -> usize {
        let pairs = self.set.hint.iter().zip(&self.verifier.activity);
        pairs.filter(|(hint, activity)| hint != activity).count()
    }

    /// The cascade: level by level, from near the last solution if the start is warm.
    fn search_levels(&mut self, levels: usize) -> Result<Status, Error> {
        self.set.reset(&self.solution.x);
        self.verifier.activity.fill(RowState::Inside);
        for level in 0..levels {
            if let LevelEnd::OutOfIterations = self.solve_level(level)? {
                self.remember_active();
                return Ok(Status::IterationLimit { level });
            }
        }
        match self.choose_least_norm() {
            LevelEnd::Solved => Ok(Status::Solved),
            LevelEnd::OutOfIterations => Ok(Status::IterationLimit { level: levels }),
        }
    }

    fn solve_level(&mut self, level: usize) -> Result<LevelEnd, Error> {
        let entry = &self.set.table.levels[level];
        let (constraints, objective) = (entry.constraints.clone(), entry.used_objective());
        let has_linear = entry.has_linear;
        let goal = (!objective.is_empty() || has_linear).then(|| Goal::Rows {
            rows: objective.clone(),
            linear_of: has_linear.then_some(level),
        });
        if let LevelEnd::OutOfIterations = self.make_feasible(level, constraints)? {
            return Ok(LevelEnd::OutOfIterations);
        }
        self.set.place_soft(objective.clone());
        let end = goal.as_ref().map_or(End::Optimal, |goal| self.set.search(goal));
        match end {
            End::Unbounded => return Err(Error::Unbounded { level }),
            End::OutOfIterations => return Ok(LevelEnd::OutOfIterations),
            End::Optimal => {}
        }
        self.set.settle(goal.as_ref(), &mut self.verifier.activity);
        Ok(LevelEnd::Solved)
    }

    /// Brings x to where the new hard constraints of `level` hold, at no cost to the levels
    /// above, by minimising their violation.
    fn make_feasible(&mut self, level: usize, rows: Range<usize>) -> Result<LevelEnd, Error> {
        self.set.place_soft(rows.clone());
        if !rows.clone().all(|id| self.set.holds(id)) {
            self.solution.x.copy_from_slice(&self.set.x);
            let goal = Goal::Rows { rows: rows.clone(), linear_of: None };
            match self.set.search(&goal) {
                End::OutOfIterations => {
                    self.set.x.copy_from_slice(&self.solution.x);
                    return Ok(LevelEnd::OutOfIterations);
                }
                End::Unbounded => return Err(Error::Unbounded { level }),
                End::Optimal => self.expect_feasible(level)?,
            }
        }
        self.set.pulled.clear(false);
        self.set.place_hard(rows);
        Ok(LevelEnd::Solved)
    }

    fn expect_feasible(&mut self, level: usize) -> Result<(), Error> {
        let rows = self.set.table.levels[level].constraints.clone();
        let excess = |set: &ActiveSet, id: usize| match set.violation(id).abs() {
            0.0 => 0.0,
            violation => violation / set.doubt(id),
        };
        let Some(worst) = rows
            .clone()
            .max_by(|&i, &j| excess(&self.set, i).total_cmp(&excess(&self.set, j)))
            .filter(|&id| excess(&self.set, id) > 1.0)
        else {
            return Ok(());
        };
        for id in rows.clone() {
            if excess(&self.set, id) > 1.0 {
                self.conflict.push(self.set.table.sources[id]);
            }
        }
        self.remember_active();
        let Self { set, verifier, conflict, .. } = self;
        let size = |id: usize| set.violation(id).abs() * set.table.norm(id);
        let threshold = self.settings.optimality_tolerance * rows.clone().map(size).sum::<f64>();
        let forces = verifier.forces_against(&set.table, rows, |id| set.violation(id));
        let pushing = forces.filter(|&(_, force)| force.abs() > threshold);
        conflict.extend(pushing.map(|(id, _)| set.table.sources[id]));
        Err(Error::Infeasible {
            level,
            worst: self.set.table.sources[worst],
            violation: self.set.violation(worst).abs() / self.set.table.scale(worst),
            members: self.conflict.len(),
        })
    }

    /// Among the optima of all levels, the one of least norm.
    fn choose_least_norm(&mut self) -> LevelEnd {
        let idle = self.set.basis.free_count() + self.set.basis.active().len() == 0;
        if !idle && self.set.search(&Goal::Norm) == End::OutOfIterations {
            self.remember_active();
            return LevelEnd::OutOfIterations;
        }
        let rounding = 10.0 * f64::EPSILON * self.set.farthest;
        if rounding > 0.0 && rounding.is_finite() && norm(&self.set.x) <= rounding {
            // Nothing but the rounding of the way there and back.
            self.set.x.fill(0.0);
        }
        self.remember_active();
        LevelEnd::Solved
    }

    /// The working set belongs to the active set of the whole.
    fn remember_active(&mut self) {
        for &id in self.set.basis.active() {
            self.verifier.activity[id] = self.set.state[id];
        }
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
                let rows = level.objective.clone();
                table.multiply(rows.clone(), &self.solution.x, &mut self.set.value);
                let squares: f64 = rows
                    .map(|id| {
                        let value = self.set.value[id];
                        (value - value.clamp(table.lower[id], table.upper[id])).powi(2)
                    })
                    .sum();
                *violation = squares.sqrt();
            }
        }
    }
}

/// Multipliers with the sources of their rows; those of a quadratic's factor become those of its
/// Hessian.
fn named(
    hierarchy: &Hierarchy,
    table: &mut RowTable,
    found: &[(usize, f64)],
) -> Result<Vec<(ConstraintSource, f64)>, Error> {
    let mut all: Vec<_> = Vec::with_capacity(found.len());
    for (level, data) in hierarchy.levels().iter().enumerate() {
        let rows = table.levels[level].clone();
        let of_level = found.iter().filter(|(id, _)| rows.objective.contains(id));
        if rows.quadratic {
            let mut multipliers = vec![0.0; rows.used];
            for &(id, multiplier) in of_level {
                multipliers[id - rows.objective.start] = multiplier;
            }
            if multipliers.iter().any(|&multiplier| multiplier != 0.0) {
                let on_hessian =
                    table.hessian_multipliers(level, data.objective(), &multipliers)?;
                all.extend(on_hessian.into_iter().map(|(row, multiplier)| {
                    (ConstraintSource::Objective { level, row }, multiplier)
                }));
            }
        } else {
            all.extend(of_level.map(|&(id, multiplier)| (table.sources[id], multiplier)));
        }
    }
    let plain = |id: usize| !matches!(table.sources[id], ConstraintSource::Objective { .. });
    let plain = found.iter().filter(|(id, _)| plain(*id));
    all.extend(plain.map(|&(id, m)| (table.sources[id], m * table.scale(id))));
    Ok(all)
}
