//! The checks of every tick.

use hrsw_safety::{Capsule, SafetyState};
use moca_model::ControllerSettings;
use moca_model::whole_body::{FrameId, Model};
use simulated_people::Joints;

use crate::error::Error;
use crate::judges::{LimitMonitor, Moment, Return, SeparationMonitor, is_unseen};
use crate::plant::{Plant, rod, separation_monitor};

/// Ticks after a disturbance of the robot in which its joints may be outside their ranges.
const SETTLING: u32 = 1000;

/// Counts of the judges since the beginning.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Ticks of the controller.
    pub ticks: u64,
    /// Ticks in which a limit of the robot was violated.
    pub limits: u64,
    /// Ticks in which the robot came nearer to a true person than it may.
    pub too_near: u64,
    /// The same by the person's own motion, which nobody blames the robot for.
    pub by_the_person: u64,
    /// Ticks that were not solved to their optimum.
    pub unsolved: u64,
}

/// Judges every tick.
#[derive(Clone, Debug)]
pub(super) struct Judge {
    limits: LimitMonitor,
    separation: SeparationMonitor,
    /// Ticks that are left of [`SETTLING`].
    settling: u32,
    pub(super) counts: Counts,
}

impl Judge {
    /// Begins with a robot at rest.
    pub(super) fn new(
        model: &Model,
        settings: &ControllerSettings,
        configuration: &[f64],
    ) -> Result<Self, Error> {
        Ok(Self {
            limits: LimitMonitor::new(model, settings, configuration),
            separation: separation_monitor(model, settings)?,
            settling: 0,
            counts: Counts::default(),
        })
    }

    /// The robot holds this, too, in the frame `tool`.
    pub(super) fn carry(&mut self, tool: FrameId, object: &Capsule) {
        self.separation.carry(tool, rod(object));
    }

    /// Distance of a person's trunk, head and legs from the robot, up to a distance that is enough \[m\].
    pub(super) fn gap(&self, joints: &Joints, enough: f64) -> f64 {
        self.separation.gap(joints, enough)
    }

    /// Judges the last step of a plant, with everybody around; whether something moves the robot that its controller
    /// does not.
    pub(super) fn check(
        &mut self,
        plant: &Plant,
        people: &[Moment<'_>],
        disturbed: bool,
    ) -> Result<(), Error> {
        let command = plant.command();
        self.settling = if disturbed { SETTLING } else { self.settling.saturating_sub(1) };
        if self.settling > 0 || is_unseen(command) {
            self.limits.move_outside(plant.reference());
        } else {
            self.limits.restart(plant.reference(), plant.configuration());
        }
        let nobody = people.iter().all(|moment| moment.known.is_none());
        let free = command.safety == SafetyState::Normal && nobody;
        let returning = if free { Return::Free } else { Return::Hindered };
        let breaches = self.limits.check(command, plant.reference(), returning);
        let range = breaches.range && self.settling == 0;
        let rates = breaches.acceleration || breaches.jerk || breaches.desired_acceleration;
        let breaks = range || breaches.limit || rates;
        let torque = plant.breaks_torque_limits() == Some(true);
        let verdict =
            self.separation.check(&command.joint_velocity, plant.configuration(), people)?;
        let counts = &mut self.counts;
        counts.ticks += 1;
        counts.limits += u64::from(breaks || torque);
        counts.too_near += u64::from(verdict.violation.is_some());
        counts.by_the_person += u64::from(verdict.person_caused);
        counts.unsolved += u64::from(!command.outcome.is_optimal());
        Ok(())
    }
}
