//! What the camera sees.

use hrsw::Fault;
use vision_models::{Body, Percept};

use super::Controller;
use crate::error::Error;

impl Controller {
    /// Takes a camera frame, stamped when it was taken, on the clock of the ticks.
    ///
    /// # Errors
    /// [`Error::Frame`] for one that counts as no data because of its time; it leaves no trace but
    /// the fault that the supervisor is told.
    pub fn observe(&mut self, percept: &Percept) -> Result<(), Error> {
        self.observe_people(percept, &[])
    }

    /// The same where other people are in view beside the person of the percept: the robot keeps its distance
    /// from each of them, and works with none.
    ///
    /// # Errors
    /// Those of [`observe`](Self::observe), and [`Error::TooManyPeople`] for more than there is room for, which
    /// stops the robot.
    pub fn observe_people(&mut self, percept: &Percept, others: &[Body]) -> Result<(), Error> {
        if let Err(fault) = self.clock.frame(percept.time) {
            self.report(fault.into());
            let (now, newest) = (self.clock.now(), self.clock.newest());
            return Err(Error::Frame { fault, stamp: percept.time, now, newest });
        }
        self.space.observe(percept)?;
        self.safety.observe(percept);
        self.look(percept);
        self.turn_to_camera()?;
        let kept = self.safety.observe_others(percept, others);
        if kept.is_err() {
            self.report(Fault::TooManyPeople);
        }
        kept
    }
}
