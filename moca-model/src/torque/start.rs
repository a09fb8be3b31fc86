//! Measurement of the response delay before the first motion.

use whole_body::control_loop::{JointCommand, JointMeasurement};
use whole_body::torque::{DelayProbe, ProbeAnswer};

use super::LONGEST_DELAY;
use super::controller::TorqueController;
use super::settings::AnswerDelay;
use crate::error::Error;

/// Share of its largest torque that pushes the probed joint.
const PUSH: f64 = 0.15;

/// Measures the delay of a robot's response while its arm is held by soft springs.
#[derive(Debug)]
pub(crate) struct Start {
    probe: DelayProbe,
    /// The joint that is pushed: the last one with a torque drive, which moves the least.
    joint: usize,
    torque: f64,
}

impl Start {
    /// Creates the measurement; `None` if the delay is known.
    pub(crate) fn of(controller: &TorqueController) -> Option<Self> {
        if matches!(controller.settings().delay, AnswerDelay::Known(_)) {
            return None;
        }
        let joint = controller.joints().len().checked_sub(1)?;
        let entry = *controller.joints().get(joint)?;
        let torque = PUSH * controller.model().limits().get(entry)?.effort;
        let (rate, period) = (controller.settings().impedance.torque_rate, controller.period());
        Some(Self { probe: DelayProbe::new(torque, rate, period), joint, torque })
    }

    /// Makes a tick. Returns true when the delay is known.
    pub(crate) fn step(
        &mut self,
        controller: &mut TorqueController,
        measured: &JointMeasurement,
        command: &mut JointCommand,
    ) -> Result<bool, Error> {
        let JointMeasurement { position, velocity, age, .. } = measured;
        let entry = controller.joints().get(self.joint).copied().unwrap_or_default();
        let is_new = *age < 0.5 * controller.period();
        let seen = velocity.get(entry).copied().filter(|velocity| is_new && velocity.is_finite());
        let push = (self.joint, self.probe.torque());
        controller.wait(measured, push);
        command.position.copy_from_slice(position);
        command.velocity.fill(0.0);
        controller.write_torques(&mut command.torque);
        match self.probe.update(seen) {
            ProbeAnswer::Pending => Ok(false),
            ProbeAnswer::Delay(delay) if delay <= LONGEST_DELAY => {
                controller.law_mut().set_delay(delay);
                Ok(true)
            }
            ProbeAnswer::Delay(delay) => Err(Error::AnswersLate { delay, longest: LONGEST_DELAY }),
            ProbeAnswer::None => {
                let names = &controller.settings().joints;
                let joint = names.last().cloned().unwrap_or_default();
                Err(Error::NoAnswer { joint, torque: self.torque })
            }
        }
    }
}
