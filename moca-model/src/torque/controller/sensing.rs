//! What a tick measures, what is known of the robot by it, and who pushes.

use hrsw_safety::Fault;
use nalgebra::Vector3;
use whole_body::torque::{JointState, MeasurementFault, SupportedMotion};

use super::{Measured, TorqueController};
use crate::error::Error;

/// Which of the measurements of a tick can be used.
#[derive(Debug, Clone, Copy)]
pub(super) struct Usable {
    pub(super) position: bool,
    pub(super) velocity: bool,
    pub(super) torque: Torques,
}

/// What is known of the torques that act on the driven joints.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Torques {
    Measured,
    /// At least one joint measures none.
    NotMeasured,
    /// At least one is no number.
    Bad,
}

impl Usable {
    fn is_bad(self) -> bool {
        !(self.position && self.velocity) || self.torque == Torques::Bad
    }
}

/// Torques older than this do not say who pushes the robot now \[s\].
const FELT: f64 = 5e-3;

/// Numbers above this are refused, as by [`Model::is_configuration`].
const LARGEST: f64 = 1e12;

fn is_sensible(value: f64) -> bool {
    value.abs() <= LARGEST
}

impl TorqueController {
    /// Where the robot is by now; a fault if that is not known well enough.
    pub(super) fn predict(&mut self, age: f64) {
        let period = self.controller.settings().period;
        let measured = JointState { position: &self.position, velocity: &self.velocity };
        let commanded = &self.controller.command().joint_velocity;
        let age = self.watch.update(measured, commanded, age, self.elapsed);
        // The sizes are those of the robot.
        let (age, awaited) = (self.delay + age, self.delay + self.watch.awaited());
        let _ = self.prediction.update(measured, commanded, age, awaited, period);
        let fault = self.watch.fault().map(|fault| match fault {
            MeasurementFault::Missing => Fault::MissingMeasurement,
            MeasurementFault::Frozen => Fault::FrozenMeasurement,
        });
        // Nothing is made up for when the robot is measured again.
        if fault.is_some() || self.is_lost {
            self.controller.restart();
        }
        self.is_lost = fault.is_some();
        if let Some(fault) = fault {
            self.controller.report(fault);
        }
    }

    /// Finds the force from outside by a new measurement, and tells the supervisor. Gravity is that of where the robot
    /// is.
    pub(super) fn feel(&mut self, usable: Usable, is_new: bool) {
        self.unobserved += self.elapsed;
        let observes = usable.torque == Torques::Measured && is_new;
        if usable.is_bad() || (observes && self.observe_force().is_err()) {
            self.controller.report(Fault::BadMeasurement);
        }
        self.feels = usable.torque == Torques::Measured;
        if usable.is_bad() || !self.feels {
            self.observer.reset();
            self.force = Vector3::zeros();
        } else if self.watch.age() <= FELT {
            self.controller.feel(self.force.norm());
        }
        self.weigh();
        // The position is that of a configuration.
        let _ = self.support();
    }

    /// Takes of what is measured what can be used.
    pub(super) fn take(&mut self, measured: &Measured<'_>) -> Usable {
        let Measured { position, velocity, torque, .. } = *measured;
        let driven = || self.joints.iter().map(|joint| torque.get(*joint).copied().flatten());
        let torques = if !driven().flatten().all(is_sensible) {
            Torques::Bad
        } else if driven().any(|torque| torque.is_none()) {
            Torques::NotMeasured
        } else {
            Torques::Measured
        };
        let usable = Usable {
            position: self.controller.robot().model().is_configuration(position),
            velocity: velocity.len() == self.velocity.len()
                && velocity.iter().all(|velocity| is_sensible(*velocity)),
            torque: torques,
        };
        if usable.velocity {
            self.velocity.copy_from_slice(velocity);
        }
        if usable.position {
            self.position.copy_from_slice(position);
        } else if usable.velocity {
            self.move_on(position);
        }
        if usable.torque == Torques::Measured {
            for (sensed, joint) in self.law.sensed.iter_mut().zip(&self.joints) {
                *sensed = torque.get(*joint).copied().flatten().unwrap_or_default();
            }
        }
        usable
    }

    /// Joints without a measured position move on at their velocities.
    fn move_on(&mut self, measured: &[f64]) {
        let period = self.controller.settings().period;
        let measured = measured.iter().copied().map(Some).chain(std::iter::repeat(None));
        for ((position, velocity), measured) in
            self.position.iter_mut().zip(&self.velocity).zip(measured)
        {
            let known = measured.filter(|measured| is_sensible(*measured));
            let next = known.unwrap_or(*position + velocity * period);
            if is_sensible(next) {
                *position = next;
            }
        }
    }

    /// Whether what pushes the robot is a weight.
    fn weigh(&mut self) {
        let gives_way = self.controller.safety().supervisor().gives_way();
        let force = Some(&self.force).filter(|_| gives_way);
        self.unknown_payload = self.payload_watch.update(force, self.elapsed);
        if self.unknown_payload.is_some() {
            self.controller.report(Fault::UnknownPayload);
        }
    }

    /// The force from outside since the last update of the observer.
    fn observe_force(&mut self) -> Result<(), Error> {
        let model = self.controller.robot().model();
        let posed = self.data.pose(model, &self.position)?;
        let mut moving = posed.moving(&self.velocity)?;
        let found = self.observer.update(&mut moving, &self.law.sensed, self.unobserved)?;
        self.unobserved = 0.0;
        self.force = self.contact.estimate(moving.posed(), found)?;
        Ok(())
    }

    /// What the arm needs beside spring and damper where it is, as it moves.
    pub(super) fn support(&mut self) -> Result<(), Error> {
        let model = self.controller.robot().model();
        let motion = SupportedMotion {
            position: self.prediction.position(),
            velocity: self.prediction.velocity(),
            acceleration: self.prediction.acceleration(),
            commanded: &self.controller.command().joint_velocity,
            share: 1.0 - self.prediction.weight(),
        };
        let torque = self.support.update(&mut self.data, model, &motion)?;
        for (own, joint) in self.law.support.iter_mut().zip(&self.joints) {
            *own = torque.get(*joint).copied().unwrap_or_default();
        }
        Ok(())
    }
}
