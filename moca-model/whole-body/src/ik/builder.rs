//! From tasks to a stack of them.

use std::ops::Range;
use std::sync::Arc;

use ahqp_core::{ContinuousStack, Hierarchy, Level};

use super::differential::Ik;
use super::settings::IkSettings;
use super::task_level::{LIMITS, LevelTasks, StackedLevel, TaskId, TaskLevel};
use crate::error::Error;
use crate::robot::model::Model;
use crate::tasks::task::{Limit, Task};

/// Collects the levels of an [`Ik`], highest priority first; see there for an example.
#[derive(Debug)]
pub struct IkBuilder {
    model: Model,
    settings: IkSettings,
    levels: Vec<TaskLevel>,
    limits: TaskLevel,
    further: usize,
}

/// Variables beside q̇ that tasks share, as [`IkBuilder::variables`] returns them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Variables {
    range: Range<usize>,
}

impl Variables {
    /// Where they stand in rows and in [`Step::variables`](crate::Step::variables).
    pub fn range(&self) -> Range<usize> {
        self.range.clone()
    }
}

impl IkBuilder {
    pub(super) fn new(model: &Model) -> Self {
        Self {
            model: model.clone(),
            settings: IkSettings::default(),
            levels: Vec::new(),
            limits: TaskLevel::new(LIMITS),
            further: 0,
        }
    }

    /// With these settings instead of the default ones.
    pub fn settings(&mut self, settings: IkSettings) -> &mut Self {
        self.settings = settings;
        self
    }

    /// Adds a task on a level of its own, below all levels so far. Level and task have the same
    /// name.
    pub fn push<T: Task>(&mut self, name: impl Into<Arc<str>>, task: T) -> TaskId<T> {
        let name = name.into();
        let mut level = TaskLevel::new(Arc::clone(&name));
        let id = level.push(name, task);
        self.levels.push(level);
        id
    }

    /// Adds a level of several tasks below all levels so far.
    pub fn push_level(&mut self, level: TaskLevel) -> &mut Self {
        self.levels.push(level);
        self
    }

    /// Adds a hard limit beside those of the joints: it holds before all tasks. Where joints cannot
    /// brake as fast as it asks, because of their acceleration and jerk limits, it is widened by what
    /// is missing, so that limits never contradict each other.
    pub fn limit<T: Limit>(&mut self, name: impl Into<Arc<str>>, limit: T) -> TaskId<T> {
        self.limits.push(name, limit)
    }

    /// Adds variables beside q̇, unbounded at first, for tasks that trade them against velocities:
    /// the rate of a desired pose, a slack.
    pub fn variables(&mut self, count: usize) -> Variables {
        let first = self.model.velocity_count() + self.further;
        self.further += count;
        Variables { range: first..first + count }
    }

    /// The inverse kinematics, with the robot at rest. Limits of the joints are the model's.
    ///
    /// # Errors
    /// [`Error::NoLevels`], [`Error::EmptyLevel`], [`Error::NameTaken`]; [`Error::InTask`] for a
    /// task that this robot cannot do; those of the settings.
    pub fn build(self) -> Result<Ik, Error> {
        self.settings.validate()?;
        let columns = self.model.velocity_count() + self.further;
        if self.levels.is_empty() {
            return Err(Error::NoLevels);
        }
        let mut hierarchy = Hierarchy::new(columns)?;
        let names = names(&self.model, self.further);
        hierarchy.name_variables(names.iter().cloned())?;
        let mut place = |level: TaskLevel, is_limit: bool| {
            let tasks = LevelTasks::new(level, &self.model)?;
            let (rows, name) = (tasks.rows(columns)?, Arc::clone(&tasks.name));
            let level =
                if is_limit { Level::constraints_only(rows) } else { Level::least_squares(rows) };
            Ok::<_, Error>(StackedLevel { id: hierarchy.push(level.named(name))?, tasks })
        };
        let limits = if self.limits.is_empty() { None } else { Some(place(self.limits, true)?) };
        let mut levels: Vec<StackedLevel> = Vec::with_capacity(self.levels.len());
        for level in self.levels {
            let level = place(level, false)?;
            let name = &level.tasks.name;
            if **name == *LIMITS || levels.iter().any(|other| other.tasks.name == *name) {
                return Err(Error::NameTaken { element: "level", name: name.to_string() });
            }
            levels.push(level);
        }
        let stack = ContinuousStack::new(&hierarchy, self.settings.solver)?;
        Ik::new(self.model, self.settings, stack, levels, limits, names)
    }
}

fn names(model: &Model, further: usize) -> Vec<Arc<str>> {
    let own = model.velocity_names().into_iter();
    own.chain((0..further).map(|index| format!("further variable {index}")))
        .map(Arc::from)
        .collect()
}
