//! The point nearest to the blend within the bounds of the output.

use nalgebra::{DMatrix, DVector};

use super::data::Data;
use crate::error::Error;
use crate::problem::hierarchy::Hierarchy;
use crate::problem::ids::LevelId;
use crate::problem::level::{Level, names_of};
use crate::problem::rows::Rows;
use crate::problem::source::ConstraintSource;
use crate::solver::Solver;
use crate::solver::budget::Budget;
use crate::solver::settings::Settings;
use crate::solver::solution::Solution;
use crate::solver::status::Status;

/// The problem min ‖x − blend‖² within the bounds of variables and output and the hard constraints.
#[derive(Debug, Clone)]
pub(super) struct Output {
    problem: Hierarchy,
    level: LevelId,
    solver: Solver,
}

impl Output {
    /// Creates the problem for the levels of `data`, or fewer.
    pub(super) fn new(data: &Data, settings: Settings) -> Result<Self, Error> {
        let variables = data.bounds.lower.len();
        let constraints = data.levels.iter().map(|level| level.constraints().len()).sum();
        let near = Rows::equalities(
            &DMatrix::<f64>::identity(variables, variables),
            &DVector::<f64>::zeros(variables),
        )?;
        let mut problem = data.frame()?;
        let level = problem.push(
            Level::least_squares(near).with_constraints(Rows::zeros(constraints, variables)),
        )?;
        Ok(Self { solver: Solver::new(&problem, settings)?, problem, level })
    }

    pub(super) fn set_settings(&mut self, settings: Settings) -> Result<(), Error> {
        self.solver.set_settings(settings)
    }

    /// Moves the solution to the nearest point at which the constraints of the levels that `binds`
    /// accepts hold.
    pub(super) fn project(
        &mut self,
        data: &Data,
        binds: impl Fn(LevelId) -> bool,
        solution: &mut Solution,
        budget: Budget,
    ) -> Result<(), Error> {
        data.write_bounds(true, &mut self.problem);
        let level = self.problem.level_mut(self.level)?;
        level.rows_mut()?.set_targets(&solution.x)?;
        let rows = level.constraints_mut();
        rows.set_free();
        let binding = data.entries().filter(|(id, _)| binds(*id));
        let constraints = binding.clone().flat_map(|(_, level)| level.constraints().iter());
        for (index, (row, lower, upper)) in constraints.enumerate() {
            rows.set_row(index, row, lower, upper)?;
        }
        let found = self.solver.solve_within(&self.problem, budget);
        let found = found.map_err(|error| in_stack(error, binding))?;
        solution.x.copy_from_slice(&found.x);
        solution.iterations += found.iterations;
        if solution.status == Status::Solved {
            solution.status = found.status.behind_all_levels();
        }
        Ok(())
    }
}

/// Replaces the level of an error by the one whose constraint cannot hold.
fn in_stack<'a>(error: Error, binding: impl Iterator<Item = (LevelId, &'a Level)>) -> Error {
    let Error::Infeasible {
        worst: ConstraintSource::Constraint { row, .. },
        violation,
        members,
        ..
    } = error
    else {
        return error;
    };
    let mut before = 0;
    for (id, level) in binding {
        let own = row - before;
        if own < level.constraints().len() {
            let worst = ConstraintSource::Constraint { level: id, row: own };
            let names = names_of(worst, Some(level), &[]);
            return Error::Infeasible { level: id, worst, violation, members, names };
        }
        before += level.constraints().len();
    }
    error
}
