//! One of the blended stacks: its levels, their order, and their solution.

use std::mem;

use super::data::Data;
use crate::certificate::Certificate;
use crate::error::Error;
use crate::problem::hierarchy::Hierarchy;
use crate::problem::ids::LevelId;
use crate::problem::level::Level;
use crate::problem::rows::Rows;
use crate::problem::source::ConstraintSource;
use crate::solver::Solver;
use crate::solver::budget::Budget;
use crate::solver::settings::Settings;
use crate::solver::solution::Solution;
use crate::solver::status::Status;

/// A level's place in an order. An inactive level only keeps its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Entry {
    pub(super) id: LevelId,
    pub(super) active: bool,
}

/// Levels in one order, some of them active, with a solver.
#[derive(Debug, Clone)]
pub(super) struct Plan {
    pub(super) order: Vec<Entry>,
    /// The problem without its levels. Each solve borrows them from the data, in exchange for empty
    /// ones.
    frame: Hierarchy,
    solver: Solver,
    solution: Solution,
    pub(super) weight: f64,
}

impl Plan {
    pub(super) fn new(order: Vec<Entry>, data: &Data, settings: Settings) -> Result<Self, Error> {
        let variables = data.bounds.lower.len();
        let mut frame = data.frame()?;
        for entry in order.iter().filter(|entry| entry.active) {
            if let Some(level) = data.level(entry.id) {
                frame.push(level.clone())?;
            }
        }
        let solver = Solver::new(&frame, settings)?;
        for id in frame.ids() {
            *frame.level_mut(id)? = Level::constraints_only(Rows::zeros(0, variables));
        }
        let solution = Solution { x: vec![0.0; variables], status: Status::Solved, iterations: 0 };
        Ok(Self { order, frame, solver, solution, weight: 0.0 })
    }

    /// Iterates over the active levels, highest priority first.
    pub(super) fn levels(&self) -> impl Iterator<Item = LevelId> + '_ {
        self.order.iter().filter(|entry| entry.active).map(|entry| entry.id)
    }

    pub(super) fn solution(&self) -> &Solution {
        &self.solution
    }

    pub(super) fn conflict(&self) -> impl Iterator<Item = ConstraintSource> + '_ {
        self.solver.conflict().iter().map(|source| source.renamed(|id| in_stack(&self.order, id)))
    }

    pub(super) fn set_settings(&mut self, settings: Settings) -> Result<(), Error> {
        self.solver.set_settings(settings)
    }

    /// Solves within the bounds, and if `narrow` is true also within those of the output.
    pub(super) fn solve(
        &mut self,
        data: &mut Data,
        narrow: bool,
        budget: Budget,
    ) -> Result<&Solution, Error> {
        data.write_bounds(narrow, &mut self.frame);
        let solved = self.with_levels(data, |solver, hierarchy, solution| {
            let found = solver.solve_within(hierarchy, budget)?;
            solution.x.copy_from_slice(&found.x);
            (solution.status, solution.iterations) = (found.status, found.iterations);
            Ok(())
        });
        let rename = |id| in_stack(&self.order, id);
        solved.map_err(|error| error.renamed(rename))?;
        self.solution.status = self.solution.status.renamed(rename);
        Ok(&self.solution)
    }

    /// Returns the problem as a plain hierarchy, and the proof of its solution.
    pub(super) fn certify(&mut self, data: &mut Data) -> Result<(Hierarchy, Certificate), Error> {
        self.with_levels(data, |solver, hierarchy, _| {
            Ok((hierarchy.clone(), solver.certificate(hierarchy)?))
        })
    }

    /// Calls `work` while the levels are in their places.
    fn with_levels<T>(
        &mut self,
        data: &mut Data,
        work: impl FnOnce(&mut Solver, &Hierarchy, &mut Solution) -> Result<T, Error>,
    ) -> Result<T, Error> {
        self.exchange_levels(data);
        let result = work(&mut self.solver, &self.frame, &mut self.solution);
        self.exchange_levels(data);
        result
    }

    fn exchange_levels(&mut self, data: &mut Data) {
        if self.levels().eq(data.ids.iter().copied()) {
            // All levels are active and in the data's order, so nothing needs to be moved.
            return self.frame.exchange_levels(&mut data.levels);
        }
        let active = self.order.iter().filter(|entry| entry.active);
        for (id, entry) in self.frame.ids().zip(active) {
            if let (Ok(place), Some(level)) = (self.frame.level_mut(id), data.level_mut(entry.id)) {
                mem::swap(place, level);
            }
        }
    }
}

/// Returns the id in the stack of a level of the plain hierarchy.
fn in_stack(order: &[Entry], id: LevelId) -> LevelId {
    let active = order.iter().filter(|entry| entry.active);
    active.map(|entry| entry.id).nth(id.index()).unwrap_or(id)
}
