//! Levels of tasks and their solver.

use std::any::Any;
use std::sync::Arc;

use ahqp_core::{Budget, Hierarchy, Level, Rows, Settings, Solution, Solver, VelocityInterval};

use super::level_tasks::LevelTasks;
use super::task_level::{TaskId, TaskLevel};

use crate::error::Error;
use crate::robot::model::Model;
use crate::state::posed::Posed;
use crate::tasks::curvature::Curvature;
use crate::tasks::input::{JacobianMemory, TaskInput};
use crate::tasks::row_block::RowBlock;
use crate::tasks::variables::VariableLayout;

/// Levels of tasks over q̇ and further variables, and their solver. It minimises the levels lexicographically, highest
/// priority first, within bounds that the caller gives and the constraints of the levels.
///
/// An [`Ik`](crate::Ik) is such a stack within the limits of a robot. Use the stack itself where bounds come from
/// elsewhere, or where tasks trade velocities against other variables.
///
/// ```
/// use whole_body::{
///     Data, stack::{Budget, TaskLevel, TaskStack}, tasks::{PostureTask, VariableLayout},
/// };
/// # use whole_body::{Description, Model};
/// # let model = Model::from_urdf(r#"<robot name="one"><link name="base"/><link name="tip"/>
/// #   <joint name="hinge" type="continuous"><parent link="base"/><child link="tip"/></joint>
/// #   </robot>"#, &Description::default())?;
/// let mut level = TaskLevel::new("posture");
/// let posture = level.push("posture", PostureTask::new());
/// let mut stack =
///     TaskStack::new(&model, &VariableLayout::new(&model), vec![level], Default::default())?;
/// stack.task_mut(posture)?.set_target(&[0.5])?;
///
/// let mut data = Data::new(&model);
/// let (lower, upper) = stack.bounds_mut();
/// (lower[0], upper[0]) = (-0.1, 0.1); // rad/s
/// stack.write(&mut data.pose(&model, &[0.0])?, &[0.0], 1e-3)?;
/// assert!((stack.solve(Budget::default())?.best()[0] - 0.1).abs() < 1e-12);
/// # Ok::<(), whole_body::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct TaskStack {
    model: Model,
    hierarchy: Hierarchy,
    solver: Solver,
    /// Tasks of each level of the hierarchy.
    levels: Vec<LevelTasks>,
    jacobian: JacobianMemory,
}

impl TaskStack {
    /// Creates a stack of these levels, highest priority first, over the variables of a layout. Bounds are infinite at
    /// first.
    ///
    /// # Errors
    /// [`Error::Nothing`], [`Error::MixedLevel`], [`Error::NameTaken`]; [`Error::InTask`] for a
    /// task that this robot cannot do; those of the solver's settings.
    pub fn new(
        model: &Model,
        variables: &VariableLayout,
        levels: Vec<TaskLevel>,
        settings: Settings,
    ) -> Result<Self, Error> {
        let names = variables.names();
        let mut hierarchy = Hierarchy::new(names.len())?;
        hierarchy.name_variables(names.iter().cloned())?;
        let mut stacked: Vec<LevelTasks> = Vec::with_capacity(levels.len());
        for level in levels {
            let tasks = LevelTasks::new(level, model)?;
            if stacked.iter().any(|other| other.name == tasks.name) {
                return Err(Error::NameTaken { element: "level", name: tasks.name.to_string() });
            }
            hierarchy.push(tasks.level(names.len())?)?;
            stacked.push(tasks);
        }
        Ok(Self {
            solver: Solver::new(&hierarchy, settings)?,
            jacobian: JacobianMemory::new(model.velocity_count()),
            model: model.clone(),
            levels: stacked,
            hierarchy,
        })
    }

    /// The bounds of all variables, to rewrite in place: `(lower, upper)`.
    pub fn bounds_mut(&mut self) -> (&mut [f64], &mut [f64]) {
        self.hierarchy.bounds_mut()
    }

    /// Sets the bounds of the first variables, those of q̇ in order.
    pub fn bound<'a>(&mut self, intervals: impl IntoIterator<Item = &'a VelocityInterval>) {
        let (lower, upper) = self.hierarchy.bounds_mut();
        for ((lower, upper), interval) in lower.iter_mut().zip(upper).zip(intervals) {
            (*lower, *upper) = (interval.lower, interval.upper);
        }
    }

    /// Lets the tasks write their data for the next `period` \[s\]. The robot is at a configuration and has moved at
    /// `velocity` (of the size of q̇). Allocates nothing, unless it returns an error.
    ///
    /// # Errors
    /// [`Error::ForeignData`] for another robot; [`Error::Size`] for the velocity;
    /// [`Error::InTask`], with the names of task and level, such as a target that was never set.
    pub fn write(
        &mut self,
        posed: &mut Posed<'_>,
        velocity: &[f64],
        period: f64,
    ) -> Result<(), Error> {
        posed.data.check(&self.model)?;
        crate::error::check_size("q̇", velocity.len(), self.model.velocity_count())?;
        self.write_with(posed, velocity, period, |_, _| {})
    }

    /// Writes the data of the tasks and calls `each` for every level that was written, highest priority first.
    pub(crate) fn write_with(
        &mut self,
        posed: &mut Posed<'_>,
        velocity: &[f64],
        period: f64,
        mut each: impl FnMut(usize, &mut Level),
    ) -> Result<(), Error> {
        self.jacobian.forget();
        let mut input = TaskInput::new(posed, velocity, period, &mut self.jacobian);
        for ((index, tasks), id) in self.levels.iter_mut().enumerate().zip(self.hierarchy.ids()) {
            let level = self.hierarchy.level_mut(id)?;
            tasks.write(&mut input, level)?;
            each(index, level);
        }
        Ok(())
    }

    /// Sets targets that were never set to the present state.
    ///
    /// # Errors
    /// [`Error::ForeignData`] for another robot; [`Error::InTask`].
    pub fn hold(&mut self, posed: &mut Posed<'_>) -> Result<(), Error> {
        posed.data.check(&self.model)?;
        self.jacobian.forget();
        let mut input = TaskInput::new(posed, &[], 0.0, &mut self.jacobian);
        self.levels.iter_mut().try_for_each(|tasks| tasks.hold(&mut input))
    }

    /// Solves for the optimal variables within a budget: q̇, then the further variables. Allocates nothing.
    ///
    /// # Errors
    /// [`Error::Hierarchy`] for data that are not finite, or constraints that cannot hold together.
    pub fn solve(&mut self, budget: Budget) -> Result<&Solution, Error> {
        Ok(self.solver.solve_within(&self.hierarchy, budget)?)
    }

    /// The last solution; `None` before the first and after an error.
    pub fn solution(&self) -> Option<&Solution> {
        self.solver.solution()
    }

    /// The problem, as the tasks were written last.
    pub fn hierarchy(&self) -> &Hierarchy {
        &self.hierarchy
    }

    /// A task, for setting its target.
    ///
    /// # Errors
    /// [`Error::UnknownTask`] for the id of another stack.
    pub fn task_mut<T: Any>(&mut self, id: TaskId<T>) -> Result<&mut T, Error> {
        let found = self.levels.iter_mut().find_map(|tasks| tasks.task_mut(id.number));
        found.and_then(|task| task.downcast_mut()).ok_or(Error::UnknownTask)
    }

    /// The rows of a block in the problem's data.
    ///
    /// # Errors
    /// [`Error::UnknownTask`] for the id of another stack, and for a block that is not alone in its level.
    pub fn block(&self, id: TaskId<RowBlock>) -> Result<&Rows, Error> {
        let found = self.levels().find_map(|(tasks, level)| tasks.block(id.number, level));
        found.ok_or(Error::UnknownTask)
    }

    /// The rows of a block in the problem's data, to write before [`solve`](Self::solve).
    ///
    /// # Errors
    /// As [`block`](Self::block).
    pub fn block_mut(&mut self, id: TaskId<RowBlock>) -> Result<&mut Rows, Error> {
        let mut levels = self.levels.iter().zip(self.hierarchy.ids());
        let found = levels.find(|(tasks, _)| tasks.has_block(id.number));
        let (tasks, level) = found.ok_or(Error::UnknownTask)?;
        let level = self.hierarchy.level_mut(level)?;
        tasks.block_mut(id.number, level).ok_or(Error::UnknownTask)
    }

    /// The robot.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The names of all variables: entries of q̇, then further ones.
    pub fn names(&self) -> &[Arc<str>] {
        self.hierarchy.variable_names()
    }

    /// The levels with their tasks and data, highest priority first.
    pub(crate) fn levels(&self) -> impl Iterator<Item = (&LevelTasks, &Level)> {
        self.levels.iter().zip(self.hierarchy.levels())
    }

    /// The rows that a level minimises, with the index of [`levels`](Self::levels).
    pub(crate) fn rows_mut(&mut self, index: usize) -> Option<&mut Rows> {
        let id = self.hierarchy.ids().nth(index)?;
        self.hierarchy.rows_mut(id).ok()
    }

    /// Adds the curvature of what the rows of a level control, each times its factor. The robot is where the tasks were
    /// written last.
    pub(crate) fn add_curvature(
        &mut self,
        index: usize,
        posed: &mut Posed<'_>,
        factors: &[f64],
        curvature: &mut Curvature,
    ) -> Result<(), Error> {
        let mut input = TaskInput::new(posed, &[], 0.0, &mut self.jacobian);
        let tasks = self.levels.get(index);
        tasks.map_or(Ok(()), |tasks| tasks.add_curvature(factors, &mut input, curvature))
    }
}
