//! Levels of tasks with strict priorities, and their solver.

pub(crate) mod level_tasks;
mod row_tasks;
pub(crate) mod task_level;
pub(crate) mod task_stack;

pub use ahqp_core::{Budget, Settings, Solution, Status};
pub use task_level::{TaskId, TaskLevel};
pub use task_stack::TaskStack;
