pub(crate) mod curvature_rows;
pub(crate) mod level_tasks;
mod row_tasks;
pub(crate) mod task_level;
pub(crate) mod task_stack;
