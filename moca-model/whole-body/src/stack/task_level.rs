//! Levels: tasks of one priority.

use std::fmt;
use std::marker::PhantomData;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::tasks::quadratic::QuadraticTask;
use crate::tasks::task::Task;

/// A level: tasks of one priority. If they cannot all be met, their weighted squared errors are minimised together.
///
/// A level may have hard constraints, which hold from this level on downwards. A level of constraints alone minimises
/// nothing. Quadratics need levels of their own, without rows to minimise.
///
/// ```
/// use whole_body::stack::TaskLevel;
/// use whole_body::tasks::FrameTask;
/// # use whole_body::{Description, Model};
/// # let model = Model::from_urdf(r#"<robot name="two"><link name="base"/><link name="left"/>
/// #   <link name="right"/><joint name="l" type="continuous"><parent link="base"/><child link="left"/>
/// #   </joint><joint name="r" type="continuous"><parent link="base"/><child link="right"/></joint>
/// #   </robot>"#, &Description::default())?;
/// let mut tools = TaskLevel::new("tools");
/// let left = tools.push("left", FrameTask::new(model.frame_id("left")?));
/// let right = tools.push("right", FrameTask::new(model.frame_id("right")?));
/// # let _ = (left, right);
/// # Ok::<(), whole_body::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct TaskLevel {
    pub(super) name: Arc<str>,
    pub(super) rows: Vec<Named<dyn Task>>,
    pub(super) quadratics: Vec<Named<dyn QuadraticTask>>,
    pub(super) constraints: Vec<Named<dyn Task>>,
}

#[derive(Debug)]
pub(super) struct Named<T: ?Sized> {
    pub(super) number: u64,
    pub(super) name: Arc<str>,
    pub(super) task: Box<T>,
}

impl Clone for Named<dyn Task> {
    fn clone(&self) -> Self {
        Self { number: self.number, name: Arc::clone(&self.name), task: self.task.clone_task() }
    }
}

impl Clone for Named<dyn QuadraticTask> {
    fn clone(&self) -> Self {
        Self { number: self.number, name: Arc::clone(&self.name), task: self.task.clone_task() }
    }
}

/// The id of a task of type `T`, as [`TaskLevel::push`] and [`IkBuilder::push`](crate::ik::IkBuilder::push) return it.
/// Ids are unique, except that a stack and its clones share theirs.
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

static COUNT: AtomicU64 = AtomicU64::new(0);

impl<T> TaskId<T> {
    fn next() -> Self {
        Self { number: COUNT.fetch_add(1, Ordering::Relaxed), kind: PhantomData }
    }
}

impl TaskLevel {
    /// Creates a level without tasks.
    pub fn new(name: impl Into<Arc<str>>) -> Self {
        let (rows, quadratics, constraints) = (Vec::new(), Vec::new(), Vec::new());
        Self { name: name.into(), rows, quadratics, constraints }
    }

    /// Adds a task.
    pub fn push<T: Task>(&mut self, name: impl Into<Arc<str>>, task: T) -> TaskId<T> {
        let id = TaskId::next();
        self.rows.push(Named { number: id.number, name: name.into(), task: Box::new(task) });
        id
    }

    /// Adds a task that minimises a quadratic.
    pub fn push_quadratic<T: QuadraticTask>(
        &mut self,
        name: impl Into<Arc<str>>,
        task: T,
    ) -> TaskId<T> {
        let id = TaskId::next();
        self.quadratics.push(Named { number: id.number, name: name.into(), task: Box::new(task) });
        id
    }

    /// Adds rows that must hold from this level on downwards. If no velocity satisfies them, the solver returns an
    /// error.
    pub fn constrain<T: Task>(&mut self, name: impl Into<Arc<str>>, task: T) -> TaskId<T> {
        let id = TaskId::next();
        self.constraints.push(Named { number: id.number, name: name.into(), task: Box::new(task) });
        id
    }

    /// Name of the level.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// True if it has neither tasks nor constraints.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty() && self.quadratics.is_empty() && self.constraints.is_empty()
    }
}
