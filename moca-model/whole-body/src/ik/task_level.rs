//! Tasks of one priority.

use std::any::Any;
use std::fmt;
use std::marker::PhantomData;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use ahqp_core::{LevelId, Rows};

use crate::error::Error;
use crate::robot::model::Model;
use crate::tasks::input::TaskInput;
use crate::tasks::rows::TaskRows;
use crate::tasks::task::Task;

/// Tasks of one priority: where they cannot all be met, the weighted squares of what is missing are
/// minimised together.
///
/// ```
/// use whole_body::{FrameTask, TaskLevel};
/// # use whole_body::{Description, Model};
/// # let model = Model::from_urdf(r#"<robot name="two"><link name="base"/><link name="left"/>
/// #   <link name="right"/><joint name="l" type="continuous"><parent link="base"/><child link="left"/>
/// #   </joint><joint name="r" type="continuous"><parent link="base"/><child link="right"/></joint>
/// #   </robot>"#, &Description::default())?;
/// let mut hands = TaskLevel::new("hands");
/// let left = hands.push("left", FrameTask::new(model.frame_id("left")?));
/// let right = hands.push("right", FrameTask::new(model.frame_id("right")?));
/// # let _ = (left, right);
/// # Ok::<(), whole_body::Error>(())
/// ```
#[derive(Debug)]
pub struct TaskLevel {
    name: Arc<str>,
    tasks: Vec<Named>,
}

#[derive(Debug)]
struct Named {
    number: u64,
    name: Arc<str>,
    task: Box<dyn Task>,
}

/// A task of type `T` in a stack, as [`TaskLevel::push`] and [`IkBuilder::push`](crate::IkBuilder::push)
/// return it. No two tasks have one id.
pub struct TaskId<T> {
    pub(crate) number: u64,
    kind: PhantomData<fn() -> T>,
}

impl<T> Clone for TaskId<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for TaskId<T> {}

impl<T> fmt::Debug for TaskId<T> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "TaskId({})", self.number)
    }
}

/// The name of the level of hard limits.
pub(crate) const LIMITS: &str = "limits";

static COUNT: AtomicU64 = AtomicU64::new(0);

impl TaskLevel {
    /// Without tasks yet.
    pub fn new(name: impl Into<Arc<str>>) -> Self {
        Self { name: name.into(), tasks: Vec::new() }
    }

    /// Adds a task.
    pub fn push<T: Task>(&mut self, name: impl Into<Arc<str>>, task: T) -> TaskId<T> {
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        self.tasks.push(Named { number, name: name.into(), task: Box::new(task) });
        TaskId { number, kind: PhantomData }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.tasks.is_empty()
    }
}

/// A level of a stack.
#[derive(Debug)]
pub(crate) struct StackedLevel {
    pub(crate) id: LevelId,
    pub(crate) tasks: LevelTasks,
}

/// The tasks of a level, or the limits, with their places in its rows.
#[derive(Debug)]
pub(crate) struct LevelTasks {
    pub(crate) name: Arc<str>,
    tasks: Vec<TaskEntry>,
    weights: Vec<f64>,
    pub(crate) is_damped: bool,
}

#[derive(Debug)]
struct TaskEntry {
    named: Named,
    first: usize,
    count: usize,
}

impl LevelTasks {
    /// Checks the tasks and gives each its rows.
    pub(crate) fn new(level: TaskLevel, model: &Model) -> Result<Self, Error> {
        let TaskLevel { name, tasks } = level;
        if tasks.is_empty() {
            return Err(Error::EmptyLevel { level: name.to_string() });
        }
        let mut entries: Vec<TaskEntry> = Vec::with_capacity(tasks.len());
        let mut first = 0;
        for named in tasks {
            if entries.iter().any(|other| other.named.name == named.name) {
                let name = named.name.to_string();
                return Err(Error::NameTaken { element: "task", name });
            }
            let count = named.task.dimension(model);
            let check = named.task.validate(model);
            let check = check.and(if count > 0 { Ok(()) } else { Err(Error::NoRows) });
            check.map_err(|error| in_task(error, &named.name, &name))?;
            entries.push(TaskEntry { named, first, count });
            first += count;
        }
        let is_damped = entries.iter().any(|entry| entry.named.task.is_damped());
        Ok(Self { name, tasks: entries, weights: vec![1.0; first], is_damped })
    }

    pub(crate) fn row_count(&self) -> usize {
        self.weights.len()
    }

    /// Zero rows over so many variables, with the tasks' names.
    pub(crate) fn rows(&self, columns: usize) -> Result<Rows, Error> {
        let names = self.tasks.iter().flat_map(|entry| {
            let name = &entry.named.name;
            (0..entry.count).map(move |row| {
                if entry.count == 1 { name.to_string() } else { format!("{name} {row}") }
            })
        });
        let mut rows =
            Rows::zeros(self.row_count(), columns).with_names(names.collect::<Vec<_>>())?;
        rows.set_weights(&self.weights)?;
        Ok(rows)
    }

    /// Lets each task write its rows.
    pub(crate) fn write(
        &mut self,
        input: &mut TaskInput<'_, '_>,
        rows: &mut Rows,
    ) -> Result<(), Error> {
        for entry in &mut self.tasks {
            let mut own = TaskRows::new(rows, &mut self.weights, entry.first, entry.count);
            own.clear();
            let written = entry.named.task.write(input, &mut own);
            written.map_err(|error| in_task(error, &entry.named.name, &self.name))?;
        }
        Ok(rows.set_weights(&self.weights)?)
    }

    pub(crate) fn task_mut<T: Task>(&mut self, id: TaskId<T>) -> Option<&mut T> {
        let entry = self.tasks.iter_mut().find(|entry| entry.named.number == id.number)?;
        let task: &mut dyn Any = entry.named.task.as_mut();
        task.downcast_mut()
    }

    /// The rows of a task.
    pub(crate) fn rows_of(&self, number: u64) -> Option<std::ops::Range<usize>> {
        let entry = self.tasks.iter().find(|entry| entry.named.number == number)?;
        Some(entry.first..entry.first + entry.count)
    }

    /// The name of the task that a row belongs to.
    pub(crate) fn task_name(&self, row: usize) -> &str {
        let entry = self.tasks.iter().find(|entry| row < entry.first + entry.count);
        entry.map_or("", |entry| &entry.named.name)
    }
}

#[cold]
fn in_task(error: Error, task: &str, level: &str) -> Error {
    Error::InTask { task: task.to_owned(), level: level.to_owned(), source: Box::new(error) }
}
