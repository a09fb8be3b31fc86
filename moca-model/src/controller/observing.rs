//! What the camera sees.

use hrsw_safety::{Fault, FrameFault, SafetyInput};
use vision_models::{Body, ImpossibleBody, Percept};

use super::Controller;
use crate::error::Error;

impl Controller {
    /// Takes the time `now` of the tick that follows \[s\], before the camera frames that have arrived by then: after
    /// a late tick they are newer than the tick before, and not from the future.
    pub fn set_present(&mut self, now: f64) {
        self.clock.set_present(now);
    }

    /// Takes a camera frame, stamped when it was taken, on the clock of the ticks.
    ///
    /// # Errors
    /// [`Error::Frame`] for one that counts as no data because of its time, [`Error::Body`] for one that shows what
    /// no person can be; it leaves no trace but the fault that the supervisor is told. [`BodySpeed`](hrsw_safety::Error::BodySpeed) for a
    /// person who is where nobody can have gone since the frame before: the robot keeps its distance from there,
    /// and from where they were, and follows neither.
    pub fn observe(&mut self, percept: &Percept) -> Result<(), Error> {
        self.observe_people(percept, &[])
    }

    /// The same where other people are in view beside the person of the percept: the robot keeps its distance
    /// from each of them, and works with none.
    ///
    /// # Errors
    /// Those of [`observe`](Self::observe), and [`TooManyPeople`](hrsw_safety::Error::TooManyPeople) for more than there is room for, which
    /// stops the robot.
    pub fn observe_people(&mut self, percept: &Percept, others: &[Body]) -> Result<(), Error> {
        self.check_bodies(percept.body.iter().chain(others))?;
        if let Err(fault) = self.clock.frame(percept.time) {
            self.report(fault.into());
            let (now, newest) = (self.clock.now(), self.clock.newest());
            return Err(Error::Frame { fault, stamp: percept.time, now, newest });
        }
        if let Err(error) = self.safety.observe(percept) {
            self.report(FrameFault::ImpossibleSpeed.into());
            return Err(error.into());
        }
        self.space.observe(percept)?;
        self.look(percept);
        self.turn_to_camera()?;
        let kept = self.safety.observe_others(percept, others);
        if kept.is_err() {
            self.report(Fault::TooManyPeople);
        }
        Ok(kept?)
    }

    /// Checks that people can have these bodies, in metres about the robot. Every source of frames comes by here.
    fn check_bodies<'a>(&mut self, bodies: impl Iterator<Item = &'a Body>) -> Result<(), Error> {
        let origin = self.robot.world_from_tool().translation.vector.into();
        let least = self.settings.safety.person.least_confidence;
        for body in bodies {
            if let Err(body) = body.check_possible(&origin, least) {
                let fault = match body {
                    ImpossibleBody::Far { .. } => FrameFault::Units,
                    _ => FrameFault::ImpossibleBody,
                };
                self.report(fault.into());
                return Err(Error::Body { fault, body });
            }
        }
        Ok(())
    }

    /// Where the person is, and how far from the robot.
    pub(super) fn watch(&mut self, elapsed: f64) -> Result<(), Error> {
        let Some(now) = self.clock.now() else { return Ok(()) };
        self.space.advance(now, elapsed)?;
        let input = SafetyInput {
            now,
            elapsed,
            age: self.clock.age(),
            together: self.space.is_shared(),
            feels: self.feels,
        };
        let (robot, safety, velocity) =
            (&mut self.robot, &mut self.safety, &self.command.joint_velocity);
        if safety.needs_inertia() {
            robot.weigh()?;
        }
        safety.measure(&robot.motion(velocity), robot.bodies(), &input)?;
        if safety.needs_inertia() && robot.inverse_inertia().is_none() {
            robot.weigh()?;
            if robot.inverse_inertia().is_some() {
                safety.measure_people(&robot.motion(velocity), robot.bodies())?;
            }
        }
        safety.decide(robot.bodies(), &input);
        Ok(())
    }
}
