//! The tasks of a level and the level that they write.

use std::any::Any;
use std::ops::Range;
use std::sync::Arc;

use ahqp_core::{Level, Objective, Rows};
use nalgebra::{DMatrix, DVector};

use super::row_tasks::{RowTasks, in_task};
use super::task_level::{Named, TaskLevel};
use crate::error::Error;
use crate::robot::model::Model;
use crate::tasks::curvature::Curvature;
use crate::tasks::input::TaskInput;
use crate::tasks::quadratic::{QuadraticTask, TaskQuadratic};

/// The tasks of a level: rows or quadratics to minimise, and hard constraints.
#[derive(Debug, Clone)]
pub(crate) struct LevelTasks {
    pub(crate) name: Arc<str>,
    rows: RowTasks,
    quadratics: Vec<Named<dyn QuadraticTask>>,
    constraints: RowTasks,
    pub(crate) is_damped: bool,
}

impl LevelTasks {
    pub(super) fn new(level: TaskLevel, model: &Model) -> Result<Self, Error> {
        if level.is_empty() {
            return Err(Error::Nothing { what: format!("level `{}` has no tasks", level.name) });
        }
        let TaskLevel { name, rows, quadratics, constraints } = level;
        if !rows.is_empty() && !quadratics.is_empty() {
            return Err(Error::MixedLevel { level: name.to_string() });
        }
        let mut names: Vec<&str> =
            rows.iter().chain(&constraints).map(|task| &*task.name).collect();
        names.extend(quadratics.iter().map(|task| &*task.name));
        names.sort_unstable();
        if let Some(pair) = names.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(Error::NameTaken { element: "task", name: pair[0].to_owned() });
        }
        for named in &quadratics {
            let check = named.task.validate(model);
            check.map_err(|error| in_task(error, &named.name, &name))?;
        }
        let rows = RowTasks::new(rows, &name, model)?;
        let constraints = RowTasks::new(constraints, &name, model)?;
        let is_damped = rows.is_damped();
        Ok(Self { name, rows, quadratics, constraints, is_damped })
    }

    /// The number of rows that it minimises.
    pub(crate) fn row_count(&self) -> usize {
        self.rows.len()
    }

    /// The number of rows with those of the curvature, which follow the others.
    pub(crate) fn rows_with_curvature(&self) -> usize {
        self.rows.rows_with_curvature()
    }

    /// True if each constraint leaves accelerations the time to fade.
    pub(crate) fn anticipating_constraints(&self) -> impl Iterator<Item = bool> {
        self.constraints.anticipating()
    }

    /// True if its constraints restrict a planar base to motion along its heading.
    pub(crate) fn keeps_heading(&self) -> bool {
        self.constraints.keeps_heading()
    }

    /// Creates the level over `columns` variables, without data.
    pub(super) fn level(&self, columns: usize) -> Result<Level, Error> {
        let constraints = self.constraints.rows(columns)?;
        let level = if self.rows.len() > 0 {
            Level::least_squares(self.rows.rows(columns)?).with_constraints(constraints)
        } else if self.quadratics.is_empty() {
            Level::constraints_only(constraints)
        } else {
            let (hessian, gradient) = (DMatrix::zeros(columns, columns), DVector::zeros(columns));
            Level::quadratic(&hessian, &gradient)?.with_constraints(constraints)
        };
        Ok(level.named(Arc::clone(&self.name)))
    }

    /// Lets each task write.
    pub(super) fn write(
        &mut self,
        input: &mut TaskInput<'_, '_>,
        level: &mut Level,
    ) -> Result<(), Error> {
        if self.constraints.len() > 0 {
            self.constraints.write(&self.name, input, level.constraints_mut())?;
        }
        if self.rows.len() > 0 {
            return self.rows.write(&self.name, input, level.rows_mut()?);
        }
        if self.quadratics.is_empty() {
            return Ok(());
        }
        let (hessian, gradient) = level.quadratic_mut()?;
        let mut quadratic = TaskQuadratic::cleared(hessian, gradient);
        for named in &mut self.quadratics {
            let written = named.task.write(input, &mut quadratic);
            written.map_err(|error| in_task(error, &named.name, &self.name))?;
        }
        Ok(())
    }

    /// True if all its tasks add their curvature.
    pub(crate) fn bends(&self) -> bool {
        self.rows.bends()
    }

    /// Adds the curvature of what its rows control, each times its factor.
    pub(super) fn add_curvature(
        &self,
        factors: &[f64],
        input: &mut TaskInput<'_, '_>,
        curvature: &mut Curvature,
    ) -> Result<(), Error> {
        self.rows.add_curvature(&self.name, factors, input, curvature)
    }

    /// Sets missing targets of tasks to the present state.
    pub(super) fn hold(&mut self, input: &mut TaskInput<'_, '_>) -> Result<(), Error> {
        self.rows.hold(&self.name, input)?;
        self.constraints.hold(&self.name, input)
    }

    pub(super) fn task_mut(&mut self, number: u64) -> Option<&mut dyn Any> {
        let quadratic = self.quadratics.iter_mut().find(|named| named.number == number);
        if let Some(named) = quadratic {
            return Some(named.task.as_mut());
        }
        let rows = self.rows.task_mut(number);
        rows.or_else(|| self.constraints.task_mut(number))
    }

    /// The rows that a task minimises, as a range of those of the level.
    pub(crate) fn rows_of(&self, number: u64) -> Option<Range<usize>> {
        self.rows.rows_of(number)
    }

    /// True if a task is alone among the minimised rows, or alone among the constraints.
    pub(super) fn has_block(&self, number: u64) -> bool {
        self.rows.is_only(number) || self.constraints.is_only(number)
    }

    /// The rows of a task that is [alone](Self::has_block).
    pub(super) fn block<'a>(&self, number: u64, level: &'a Level) -> Option<&'a Rows> {
        match level.objective() {
            Objective::LeastSquares(rows) if self.rows.is_only(number) => Some(rows),
            _ => self.constraints.is_only(number).then(|| level.constraints()),
        }
    }

    /// The rows of a task that is [alone](Self::has_block), to write.
    pub(super) fn block_mut<'a>(&self, number: u64, level: &'a mut Level) -> Option<&'a mut Rows> {
        if self.rows.is_only(number) {
            level.rows_mut().ok()
        } else {
            self.constraints.is_only(number).then(|| level.constraints_mut())
        }
    }

    /// The rows of a level, the number of task rows among them, and their names: minimised rows first, then
    /// constraints.
    pub(crate) fn named_rows<'a>(
        &'a self,
        level: &'a Level,
    ) -> impl Iterator<Item = (&'a Rows, usize, impl Fn(usize) -> &'a str)> {
        let minimised = match level.objective() {
            Objective::LeastSquares(rows) => Some((rows, &self.rows)),
            _ => None,
        };
        let pairs = minimised.into_iter().chain([(level.constraints(), &self.constraints)]);
        pairs.map(|(rows, tasks)| (rows, tasks.len(), |row| tasks.task_name(row)))
    }
}
