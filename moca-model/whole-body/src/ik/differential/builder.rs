//! Construction of an [`Ik`] from tasks.

use std::sync::Arc;

use super::Ik;
use crate::error::Error;
use crate::ik::settings::IkSettings;
use crate::robot::model::Model;
use crate::stack::task_level::{TaskId, TaskLevel};
use crate::stack::task_stack::TaskStack;
use crate::tasks::quadratic::QuadraticTask;
use crate::tasks::task::{Limit, Task};
use crate::tasks::variables::{VariableLayout, Variables};

/// The name of the level of hard limits, which no other level may have.
const LIMITS: &str = "limits";

/// Collects the levels of an [`Ik`], highest priority first; see there for an example.
#[derive(Debug, Clone)]
pub struct IkBuilder {
    model: Model,
    settings: IkSettings,
    levels: Vec<TaskLevel>,
    limits: TaskLevel,
    variables: VariableLayout,
}

impl IkBuilder {
    pub(super) fn new(model: &Model) -> Self {
        Self {
            model: model.clone(),
            settings: IkSettings::default(),
            levels: Vec::new(),
            limits: TaskLevel::new(LIMITS),
            variables: VariableLayout::new(model),
        }
    }

    /// Sets the settings, in place of the default ones.
    pub fn settings(&mut self, settings: IkSettings) -> &mut Self {
        self.settings = settings;
        self
    }

    /// Adds a task on a level of its own below all present levels. Level and task have the same name.
    pub fn push<T: Task>(&mut self, name: impl Into<Arc<str>>, task: T) -> TaskId<T> {
        let name = name.into();
        let mut level = TaskLevel::new(Arc::clone(&name));
        let id = level.push(name, task);
        self.levels.push(level);
        id
    }

    /// Adds a task that minimises a quadratic on a level of its own below all present levels.
    pub fn push_quadratic<T: QuadraticTask>(
        &mut self,
        name: impl Into<Arc<str>>,
        task: T,
    ) -> TaskId<T> {
        let name = name.into();
        let mut level = TaskLevel::new(Arc::clone(&name));
        let id = level.push_quadratic(name, task);
        self.levels.push(level);
        id
    }

    /// Adds a level of several tasks below all present levels.
    pub fn push_level(&mut self, level: TaskLevel) -> &mut Self {
        self.levels.push(level);
        self
    }

    /// Adds a hard limit beside those of the joints, above all tasks. The acceleration and jerk limits of the joints
    /// may not allow them to brake as fast as it asks. The limit is then widened by the difference, so that limits
    /// never contradict each other.
    pub fn limit<T: Limit>(&mut self, name: impl Into<Arc<str>>, limit: T) -> TaskId<T> {
        self.limits.constrain(name, limit)
    }

    /// Adds variables beside q̇, unbounded at first, for tasks that trade them against velocities. Examples are the
    /// rate of a desired pose and a slack.
    pub fn variables(&mut self, name: &str, count: usize) -> Variables {
        self.variables.add(name, count)
    }

    /// Builds the inverse kinematics, with the robot at rest. The limits of the joints are the model's.
    ///
    /// # Errors
    /// [`Error::Nothing`], [`Error::MixedLevel`], [`Error::NameTaken`]; [`Error::InTask`] for a task that this robot
    /// cannot do; those of the settings.
    pub fn build(self) -> Result<Ik, Error> {
        self.settings.validate()?;
        if self.levels.is_empty() {
            return Err(Error::Nothing { what: "there is no level of tasks".into() });
        }
        self.levels.iter().try_for_each(expect_other_name)?;
        let has_limits = !self.limits.is_empty();
        let limits = has_limits.then_some(self.limits);
        let levels = limits.into_iter().chain(self.levels).collect();
        let stack = TaskStack::new(&self.model, &self.variables, levels, self.settings.solver)?;
        Ik::new(self.model, self.settings, stack, has_limits)
    }

    /// Builds the inverse kinematics with the robot at rest at the configuration `q`. Targets that were not set are set
    /// to what the robot has there, as by [`Ik::hold`].
    ///
    /// # Errors
    /// Those of [`build`](Self::build) and [`Ik::hold`].
    pub fn build_at(self, q: &[f64]) -> Result<Ik, Error> {
        let mut ik = self.build()?;
        ik.hold(q)?;
        Ok(ik)
    }
}

/// Returns an error for a level with the name of the limits.
fn expect_other_name(level: &TaskLevel) -> Result<(), Error> {
    if level.name() == LIMITS {
        return Err(Error::NameTaken { element: "level", name: LIMITS.to_owned() });
    }
    Ok(())
}
