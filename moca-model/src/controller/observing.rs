//! Camera frames.

use hrsw_safety::{Fault, FrameFault, LEAST_CONFIDENCE, SafetyInput};
use vision_models::{Body, ImpossibleBody};

use super::Controller;
use crate::error::Error;
use crate::interaction::Phase;
use crate::scene::Scene;

impl Controller {
    /// Sets the time `now` of the next tick \[s\]. Call it before the camera frames that have arrived by then. After a
    /// late tick they are newer than the last tick, and must not count as frames from the future.
    pub fn set_present(&mut self, now: f64) {
        self.clock.set_present(now);
    }

    /// Takes a camera frame, stamped on the clock of the ticks when it was taken: a [`Percept`](vision_models::Percept)
    /// for one person, or a [`Scene`] with everybody in view. The robot keeps its distance from each of the others, and
    /// works with none. People whose source has no ids are told apart by their places.
    ///
    /// # Errors
    /// [`Error::Frame`] for a frame that counts as no data because of its time, and [`Error::Body`] for one with an
    /// impossible body. Such a frame only causes a fault of the supervisor.
    ///
    /// [`BodySpeed`](hrsw_safety::Error::BodySpeed) for a person who is farther from the last place than anybody can
    /// have gone. The robot keeps its distance from both places and follows neither.
    ///
    /// [`TooManyPeople`](hrsw_safety::Error::TooManyPeople) for more people than there is room for. They stop the robot.
    pub fn observe(&mut self, scene: impl Into<Scene>) -> Result<(), Error> {
        let mut scene = scene.into();
        self.check_bodies(scene.bodies())?;
        let time = scene.percept.time;
        if let Err(fault) = self.clock.frame(time) {
            self.report(fault.into());
            let (now, newest) = (self.clock.now(), self.clock.newest());
            return Err(Error::Frame { fault, stamp: time, now, newest });
        }
        scene.identify(&mut self.people)?;
        let percept = &scene.percept;
        let seen = self.safety.observe(percept);
        self.keep(seen)?;
        self.space.observe(percept)?;
        self.look(percept);
        self.turn_to_camera()?;
        let seen = self.safety.observe_others(percept, scene.others());
        self.keep(seen)
    }

    /// Reports the fault of a frame that safety cannot keep.
    fn keep(&mut self, seen: Result<(), hrsw_safety::Error>) -> Result<(), Error> {
        match seen {
            Err(hrsw_safety::Error::TooManyPeople { .. }) => self.report(Fault::TooManyPeople),
            Err(_) => self.report(FrameFault::ImpossibleSpeed.into()),
            Ok(()) => {}
        }
        Ok(seen?)
    }

    /// Returns an error unless people can have these bodies, in metres around the robot. All frames are checked here.
    fn check_bodies<'a>(&mut self, bodies: impl Iterator<Item = &'a Body>) -> Result<(), Error> {
        let origin = self.robot.world_from_tool().translation.vector.into();
        for body in bodies {
            if let Err(body) = body.check_possible(&origin, LEAST_CONFIDENCE) {
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

    /// Updates the person's place and the distances to the robot.
    pub(super) fn watch(&mut self, elapsed: f64) -> Result<(), Error> {
        let Some(now) = self.clock.now() else { return Ok(()) };
        if matches!(self.command.phase, Phase::Turning { .. }) {
            self.space.recentre();
        }
        let together = self.space.advance(now, elapsed)?.is_shared;
        let input = SafetyInput {
            now,
            elapsed,
            age: self.clock.age(),
            together,
            measures_force: self.reports.measures_force,
        };
        let (robot, safety, velocity) =
            (&mut self.robot, &mut self.safety, &self.command.joint_velocity);
        if safety.needs_inertia() {
            robot.update_inertia()?;
        }
        safety.measure(&robot.motion(velocity), robot.bodies(), &input)?;
        if safety.needs_inertia() && robot.inverse_inertia().is_none() {
            robot.update_inertia()?;
            if robot.inverse_inertia().is_some() {
                safety.measure_people(&robot.motion(velocity), robot.bodies())?;
            }
        }
        safety.decide(robot.bodies(), &input);
        Ok(())
    }
}
