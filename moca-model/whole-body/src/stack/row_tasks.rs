//! Tasks with consecutive rows.

use std::any::Any;
use std::ops::Range;

use ahqp_core::Rows;

use super::task_level::Named;
use crate::error::Error;
use crate::robot::model::Model;
use crate::tasks::curvature::Curvature;
use crate::tasks::input::TaskInput;
use crate::tasks::rows::TaskRows;
use crate::tasks::task::Task;

/// Tasks with the ranges of their rows in a level.
#[derive(Debug, Clone)]
pub(super) struct RowTasks {
    entries: Vec<TaskEntry>,
    count: usize,
    /// Weights of all rows, with those of the curvature.
    weights: Vec<f64>,
    /// True if rows of curvature follow those of the tasks.
    bends: bool,
}

#[derive(Debug, Clone)]
struct TaskEntry {
    named: Named<dyn Task>,
    first: usize,
    count: usize,
}

impl RowTasks {
    /// Checks the tasks and assigns rows to each.
    pub(super) fn new(
        tasks: Vec<Named<dyn Task>>,
        level: &str,
        model: &Model,
    ) -> Result<Self, Error> {
        let mut entries = Vec::with_capacity(tasks.len());
        let mut first = 0;
        for named in tasks {
            let count = named.task.dimension(model);
            let check = named.task.validate(model);
            let check = check.and(if count > 0 {
                Ok(())
            } else {
                Err(Error::Nothing { what: "it controls no axis, joint or row".into() })
            });
            check.map_err(|error| in_task(error, &named.name, level))?;
            entries.push(TaskEntry { named, first, count });
            first += count;
        }
        let has_curvature = |entry: &TaskEntry| entry.named.task.has_curvature();
        let bends = !entries.is_empty() && entries.iter().all(has_curvature);
        let rows = first + if bends { model.velocity_count() } else { 0 };
        Ok(Self { entries, count: first, weights: vec![1.0; rows], bends })
    }

    /// The number of rows of the tasks. Rows of their curvature may follow.
    pub(super) fn len(&self) -> usize {
        self.count
    }

    /// The number of rows with those of the curvature.
    pub(super) fn rows_with_curvature(&self) -> usize {
        self.weights.len()
    }

    /// True if each row leaves accelerations the time to fade.
    pub(super) fn anticipating(&self) -> impl Iterator<Item = bool> {
        self.entries
            .iter()
            .flat_map(|entry| std::iter::repeat_n(entry.named.task.anticipates(), entry.count))
    }

    pub(super) fn keeps_heading(&self) -> bool {
        self.entries.iter().any(|entry| entry.named.task.keeps_heading())
    }

    pub(super) fn is_damped(&self) -> bool {
        self.entries.iter().any(|entry| entry.named.task.is_damped())
    }

    /// Creates zero rows over `columns` variables that bound nothing, with the tasks' names.
    pub(super) fn rows(&self, columns: usize) -> Result<Rows, Error> {
        let names = self.entries.iter().flat_map(|entry| {
            let name = &entry.named.name;
            (0..entry.count).map(move |row| {
                if entry.count == 1 { name.to_string() } else { format!("{name} {row}") }
            })
        });
        let curvature =
            (self.count..self.weights.len()).map(|row| format!("curvature {}", row - self.count));
        let names = names.chain(curvature);
        let mut rows =
            Rows::zeros(self.weights.len(), columns).with_names(names.collect::<Vec<_>>())?;
        rows.set_weights(&self.weights)?;
        rows.set_free();
        Ok(rows)
    }

    /// Lets each task write its rows.
    pub(super) fn write(
        &mut self,
        level: &str,
        input: &mut TaskInput<'_, '_>,
        rows: &mut Rows,
    ) -> Result<(), Error> {
        for entry in &mut self.entries {
            let (first, count) = (entry.first, entry.count);
            let writes_all = entry.named.task.writes_all(rows.columns());
            let mut own = TaskRows::new(rows, &mut self.weights, first, count);
            if !writes_all {
                own.clear();
            }
            let written = entry.named.task.write(input, &mut own);
            written.map_err(|error| in_task(error, &entry.named.name, level))?;
        }
        let is_written = match rows.weights() {
            Some(weights) => weights == self.weights,
            None => self.weights.iter().all(|weight| *weight == 1.0),
        };
        if !is_written {
            rows.set_weights(&self.weights)?;
        }
        Ok(())
    }

    /// True if all its tasks add their curvature.
    pub(super) fn bends(&self) -> bool {
        self.bends
    }

    /// Adds the curvature of what the rows control, each times its factor.
    pub(super) fn add_curvature(
        &self,
        level: &str,
        factors: &[f64],
        input: &mut TaskInput<'_, '_>,
        curvature: &mut Curvature,
    ) -> Result<(), Error> {
        for TaskEntry { named, first, count } in &self.entries {
            let own = factors.get(*first..first + count).unwrap_or_default();
            let added = named.task.add_curvature(own, input, curvature);
            added.map_err(|error| in_task(error, &named.name, level))?;
        }
        Ok(())
    }

    pub(super) fn hold(&mut self, level: &str, input: &mut TaskInput<'_, '_>) -> Result<(), Error> {
        for TaskEntry { named, .. } in &mut self.entries {
            named.task.hold(input).map_err(|error| in_task(error, &named.name, level))?;
        }
        Ok(())
    }

    pub(super) fn task_mut(&mut self, number: u64) -> Option<&mut dyn Any> {
        let entry = self.entries.iter_mut().find(|entry| entry.named.number == number)?;
        Some(entry.named.task.as_mut())
    }

    /// True if a task is the only one.
    pub(super) fn is_only(&self, number: u64) -> bool {
        matches!(&self.entries[..], [entry] if entry.named.number == number)
    }

    /// The rows of a task.
    pub(super) fn rows_of(&self, number: u64) -> Option<Range<usize>> {
        let entry = self.entries.iter().find(|entry| entry.named.number == number)?;
        Some(entry.first..entry.first + entry.count)
    }

    /// The name of the task that a row belongs to.
    pub(super) fn task_name(&self, row: usize) -> &str {
        let entry = self.entries.iter().find(|entry| row < entry.first + entry.count);
        entry.map_or("", |entry| &entry.named.name)
    }
}

#[cold]
pub(super) fn in_task(error: Error, task: &str, level: &str) -> Error {
    Error::InTask { task: task.to_owned(), level: level.to_owned(), source: Box::new(error) }
}
