//! Measurements of a tick, prediction of the state, and external forces.

use hrsw_safety::Fault;
use nalgebra::Vector3;
use whole_body::control_loop::JointMeasurement;
use whole_body::torque::{JointState, MeasurementFault};

use super::TorqueController;
use crate::error::Error;

/// Usability of the measurements of a tick.
#[derive(Debug, Clone, Copy)]
pub(super) struct Usable {
    pub(super) position: bool,
    pub(super) velocity: bool,
    pub(super) torque: Torques,
}

/// Usability of the measured torques of the joints with torque drives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Torques {
    Measured,
    /// At least one joint has no torque sensor.
    NotMeasured,
    /// At least one torque is not a usable number.
    Bad,
}

impl Usable {
    fn is_bad(self) -> bool {
        !(self.position && self.velocity) || self.torque == Torques::Bad
    }
}

/// Age up to which torques show the present external force \[s\].
const PRESENT_FORCE: f64 = 5e-3;

/// Larger numbers are refused, as by [`Model::is_configuration`].
const LARGEST: f64 = 1e12;

fn is_sensible(value: f64) -> bool {
    value.abs() <= LARGEST
}

impl TorqueController {
    /// Predicts the present state of the robot. Reports a fault if it is not known well enough.
    pub(super) fn predict(&mut self, age: f64) {
        let measured = JointState { position: &self.position, velocity: &self.velocity };
        let commanded = &self.controller.command().joint_velocity;
        let period = self.controller.settings().period;
        // The sizes are those of the robot.
        let _ = self.law.observe(measured, commanded, age, self.elapsed, period);
        let fault = self.law.fault().map(|fault| match fault {
            MeasurementFault::Missing => Fault::MissingMeasurement,
            MeasurementFault::Frozen => Fault::FrozenMeasurement,
        });
        // The commanded state restarts, so that no motion is made up for when measurements return.
        if self.law.is_recovering() {
            self.controller.restart();
        }
        self.is_lost = fault.is_some();
        if let Some(fault) = fault {
            self.controller.report(fault);
        }
    }

    /// Estimates the external force by a new measurement and reports it to the supervisor.
    pub(super) fn sense_force(&mut self, usable: Usable) {
        self.unobserved += self.elapsed;
        let observes = usable.torque == Torques::Measured && self.law.age() == 0.0;
        if usable.is_bad() || (observes && self.observe_force().is_err()) {
            self.controller.report(Fault::BadMeasurement);
        }
        self.measures_force = usable.torque == Torques::Measured;
        if usable.is_bad() || !self.measures_force {
            self.observer.reset();
            self.force = Vector3::zeros();
        } else if self.law.age() <= PRESENT_FORCE {
            self.controller.set_external_force(self.force.norm());
        }
        self.look_for_payload();
    }

    /// Copies the usable parts of a measurement.
    pub(super) fn take(&mut self, measured: &JointMeasurement) -> Usable {
        let JointMeasurement { position, velocity, torque, .. } = measured;
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
            for (sensed, joint) in self.sensed.iter_mut().zip(&self.joints) {
                *sensed = torque.get(*joint).copied().flatten().unwrap_or_default();
            }
        }
        usable
    }

    /// Moves joints without a measured position on at their velocities.
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

    /// Checks whether the external force is the weight of a payload.
    fn look_for_payload(&mut self) {
        let gives_way = self.controller.safety().supervisor().gives_way();
        let force = Some(&self.force).filter(|_| gives_way);
        self.unknown_payload = self.payload_watch.update(force, self.elapsed);
        if self.unknown_payload.is_some() {
            self.controller.report(Fault::UnknownPayload);
        }
    }

    /// Estimates the external force since the last update of the observer.
    fn observe_force(&mut self) -> Result<(), Error> {
        let model = self.controller.robot().model();
        let posed = self.law.data_mut().pose(model, &self.position)?;
        let mut moving = posed.moving(&self.velocity)?;
        let found = self.observer.update(&mut moving, &self.sensed, self.unobserved)?;
        self.unobserved = 0.0;
        self.force = self.contact.estimate(moving.posed(), found)?;
        Ok(())
    }
}
