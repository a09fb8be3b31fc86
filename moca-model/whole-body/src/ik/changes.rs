//! Levels that come, go and change places while the robot moves.

use ahqp_core::{LevelId, Place};

use super::differential::{Ik, expect_other_name};
use crate::error::Error;
use crate::stack::task_level::TaskLevel;

/// Changes take effect over a chosen time, so that velocities stay continuous, and limits hold
/// meanwhile: see [`TaskStack`](crate::TaskStack). These calls allocate; the steps between them do
/// not.
impl Ik {
    /// See [`TaskStack::level_id`](crate::TaskStack::level_id).
    ///
    /// # Errors
    /// As there.
    pub fn level_id(&self, name: &str) -> Result<LevelId, Error> {
        self.stack.level_id(name)
    }

    /// See [`TaskStack::insert`](crate::TaskStack::insert). The limits stay above all levels.
    ///
    /// # Errors
    /// As there.
    pub fn insert(
        &mut self,
        level: TaskLevel,
        place: Place,
        duration: f64,
    ) -> Result<LevelId, Error> {
        expect_other_name(&level)?;
        let place = match (place, self.limits) {
            (Place::Top, Some(limits)) => Place::Below(limits),
            (Place::Above(level), _) => Place::Above(self.expect_level(level)?),
            (place, _) => place,
        };
        let level = self.settings.apply(level);
        let id = self.stack.insert(level, place, duration)?;
        self.make_room();
        Ok(id)
    }

    /// See [`TaskStack::remove`](crate::TaskStack::remove).
    ///
    /// # Errors
    /// As there.
    pub fn remove(&mut self, level: LevelId, duration: f64) -> Result<(), Error> {
        self.stack.remove(self.expect_level(level)?, duration)?;
        self.make_room();
        Ok(())
    }

    /// See [`TaskStack::swap`](crate::TaskStack::swap).
    ///
    /// # Errors
    /// As there.
    pub fn swap(&mut self, one: LevelId, other: LevelId, duration: f64) -> Result<(), Error> {
        self.stack.swap(self.expect_level(one)?, self.expect_level(other)?, duration)?;
        self.make_room();
        Ok(())
    }

    /// See [`TaskStack::activate`](crate::TaskStack::activate).
    ///
    /// # Errors
    /// As there.
    pub fn activate(
        &mut self,
        level: LevelId,
        activation: f64,
        duration: f64,
    ) -> Result<(), Error> {
        self.stack.activate(self.expect_level(level)?, activation, duration)?;
        self.make_room();
        Ok(())
    }

    /// See [`TaskStack::activation`](crate::TaskStack::activation).
    ///
    /// # Errors
    /// As there.
    pub fn activation(&self, level: LevelId) -> Result<f64, Error> {
        self.stack.activation(level)
    }

    /// Whether a change is under way.
    pub fn is_changing(&self) -> bool {
        self.stack.is_changing()
    }

    /// The limits are no level that could be changed.
    fn expect_level(&self, level: LevelId) -> Result<LevelId, Error> {
        if self.limits == Some(level) {
            return Err(ahqp_core::Error::NoSuchLevel { level }.into());
        }
        Ok(level)
    }
}
