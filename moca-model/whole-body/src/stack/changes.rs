//! Levels that come, go and change places while the robot moves.

use ahqp_core::{LevelId, Place};

use super::level_tasks::{LevelTasks, StackedLevel};
use super::task_level::TaskLevel;
use super::task_stack::TaskStack;
use crate::error::Error;
use crate::urdf::names::nearest;

/// Changes take effect over a chosen time, along a minimum-jerk curve, so that the solution stays
/// continuous: see [`ContinuousStack`](ahqp_core::ContinuousStack). These calls allocate; the steps
/// between them do not.
impl TaskStack {
    /// The id of a level.
    ///
    /// # Errors
    /// [`Error::UnknownLevel`], with the most similar names first.
    pub fn level_id(&self, name: &str) -> Result<LevelId, Error> {
        let found = self.levels().find(|(_, other)| *other == name);
        found.map(|(id, _)| id).ok_or_else(|| Error::UnknownLevel {
            name: name.to_owned(),
            known: nearest(name, self.levels().map(|(_, name)| name)),
        })
    }

    /// Inserts a level within `duration` \[s\]. Targets of its tasks must be set before the next
    /// step.
    ///
    /// # Errors
    /// [`Error::EmptyLevel`], [`Error::MixedLevel`], [`Error::NameTaken`], [`Error::InTask`], and
    /// those of [`ContinuousStack::insert`](ahqp_core::ContinuousStack::insert). Nothing has changed
    /// then.
    pub fn insert(
        &mut self,
        level: TaskLevel,
        place: Place,
        duration: f64,
    ) -> Result<LevelId, Error> {
        let tasks = LevelTasks::new(level, &self.model)?;
        if self.levels().any(|(_, name)| *name == *tasks.name) {
            return Err(Error::NameTaken { element: "level", name: tasks.name.to_string() });
        }
        let id = self.solver.insert(tasks.level(self.names().len())?, place, duration)?;
        self.levels.push(StackedLevel { id, tasks });
        self.tidy();
        Ok(id)
    }

    /// Removes a level within `duration` \[s\].
    ///
    /// # Errors
    /// Those of [`ContinuousStack::remove`](ahqp_core::ContinuousStack::remove). Nothing has changed
    /// then.
    pub fn remove(&mut self, level: LevelId, duration: f64) -> Result<(), Error> {
        self.solver.remove(level, duration)?;
        self.tidy();
        Ok(())
    }

    /// Lets two levels change places within `duration` \[s\].
    ///
    /// # Errors
    /// Those of [`ContinuousStack::swap`](ahqp_core::ContinuousStack::swap). Nothing has changed then.
    pub fn swap(&mut self, one: LevelId, other: LevelId, duration: f64) -> Result<(), Error> {
        self.solver.swap(one, other, duration)?;
        self.tidy();
        Ok(())
    }

    /// Moves the activation of a level to a value from 0, where it has no influence, to 1, within
    /// `duration` \[s\].
    ///
    /// # Errors
    /// Those of [`ContinuousStack::activate`](ahqp_core::ContinuousStack::activate). Nothing has
    /// changed then.
    pub fn activate(
        &mut self,
        level: LevelId,
        activation: f64,
        duration: f64,
    ) -> Result<(), Error> {
        self.solver.activate(level, activation, duration)?;
        self.tidy();
        Ok(())
    }

    /// The activation of a level, from 0 to 1.
    ///
    /// # Errors
    /// [`Error::Hierarchy`] when its removal is over.
    pub fn activation(&self, level: LevelId) -> Result<f64, Error> {
        Ok(self.solver.activation(level)?)
    }

    /// Whether a change is under way.
    pub fn is_changing(&self) -> bool {
        self.solver.is_changing()
    }

    /// Lets go of levels that are gone, and brings the others into their order.
    fn tidy(&mut self) {
        let solver = &self.solver;
        self.levels.retain(|level| solver.level(level.id).is_ok());
        let place = |level: &StackedLevel| solver.ids().position(|id| id == level.id);
        self.levels.sort_by_key(|level| place(level).unwrap_or(usize::MAX));
    }
}
