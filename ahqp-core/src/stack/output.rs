//! The point nearest to the blend that obeys the bounds of the output.

use nalgebra::{DMatrix, DVector};

use super::LevelId;
use super::data::Data;
use crate::error::Error;
use crate::problem::hierarchy::{Hierarchy, Level};
use crate::problem::rows::Rows;
use crate::solver::Solver;
use crate::solver::settings::Settings;
use crate::solver::solution::Status;

/// min ‖x − blend‖² within the bounds of variables and output and the hard constraints.
#[derive(Debug)]
pub(super) struct Output {
    problem: Hierarchy,
    solver: Solver,
}

impl Output {
    /// For the levels of `data`, or fewer.
    pub(super) fn new(data: &Data, settings: Settings) -> Result<Self, Error> {
        let variables = data.bounds.lower.len();
        let constraints = data.levels.iter().map(|(_, level)| level.constraints().len()).sum();
        let near = Rows::equalities(
            &DMatrix::<f64>::identity(variables, variables),
            &DVector::<f64>::zeros(variables),
        )?;
        let mut problem = Hierarchy::new(variables)?;
        problem.push(
            Level::least_squares(near).with_constraints(Rows::zeros(constraints, variables)),
        )?;
        Ok(Self { solver: Solver::new(&problem, settings)?, problem })
    }

    /// Moves `x` to the nearest point; the constraints of the levels that `binds` names hold.
    pub(super) fn project(
        &mut self,
        data: &Data,
        binds: impl Fn(LevelId) -> bool,
        x: &mut [f64],
    ) -> Result<Status, Error> {
        data.write_bounds(true, &mut self.problem);
        let level = self.problem.level_mut(0)?;
        if let Some(near) = level.least_squares_mut() {
            near.lower_mut().copy_from_slice(x);
            near.upper_mut().copy_from_slice(x);
        }
        let rows = level.constraints_mut();
        rows.lower_mut().fill(f64::NEG_INFINITY);
        rows.upper_mut().fill(f64::INFINITY);
        let binding = data.levels.iter().filter(|(id, _)| binds(*id));
        let binding = binding.flat_map(|(_, level)| level.constraints().iter());
        for (index, (row, lower, upper)) in binding.enumerate().take(rows.len()) {
            if let Some(to) = rows.row_mut(index) {
                to.copy_from_slice(row);
            }
            (rows.lower_mut()[index], rows.upper_mut()[index]) = (lower, upper);
        }
        let solution = self.solver.solve(&self.problem)?;
        x.copy_from_slice(solution.x());
        Ok(solution.status())
    }
}
