//! Information for people, before the robot moves and while it does.

use std::time::Instant;

use moca_model::whole_body::control_loop::{ControlLaw, JointCommand, JointMeasurement};
use moca_model::{Acknowledgement, Error, LoopController};

use super::fault_log::FaultLog;
use super::first_motion::circle;
use super::loop_tick::{TickSender, Ticks, tick_channel};

/// A [`LoopController`] that tells people once, before the first command, which inputs are missing. It also keeps a log
/// of its faults, and tells another thread what it does in each tick.
///
/// ```
/// use ergo_map::ErgonomicsQuadratic;
/// use moca_drivers::AnnouncedLaw;
/// use moca_model::whole_body::control_loop::{ControlLaw, JointCommand, JointMeasurement};
/// use moca_model::whole_body::torque::Compensation;
/// use moca_model::{
///     Controller, ControllerSettings, LoopController, MOCA_HOME, TorqueController, TorqueLoopSettings, moca,
/// };
/// use nalgebra::{Matrix3, Vector3};
///
/// let ergonomics = ErgonomicsQuadratic::new(Matrix3::identity(), Vector3::zeros(), 1.0)?;
/// let controller = Controller::new(moca()?, ergonomics, ControllerSettings::default(), &MOCA_HOME)?;
/// let controller = TorqueController::new(controller, TorqueLoopSettings::new(Compensation::BARE))?;
/// let (law, frames) = LoopController::new(controller);
/// let (mut law, ticks) = AnnouncedLaw::new(law, |text: &str| assert!(text.contains("torques")));
/// let measured = JointMeasurement::resting(MOCA_HOME.to_vec(), MOCA_HOME.len());
/// let mut command = JointCommand::at_rest(&measured);
/// law.step(0.001, &measured, &mut command)?;
/// // Another thread reads what it did.
/// let mut told = 0;
/// ticks.read(|tick| told += u32::from(tick.row.q == MOCA_HOME));
/// assert_eq!(told, 1);
/// # drop(frames);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct AnnouncedLaw<F> {
    law: LoopController,
    tell: F,
    faults: FaultLog,
    ticks: TickSender,
    circles: bool,
}

impl<F: FnMut(&str)> AnnouncedLaw<F> {
    /// Creates a law from a controller and the function that tells people. Also returns its ticks, for another thread.
    pub fn new(law: LoopController, tell: F) -> (Self, Ticks) {
        let (sender, ticks) = tick_channel(law.controller().controller());
        (Self { law, tell, faults: FaultLog::default(), ticks: sender, circles: false }, ticks)
    }

    /// Lets the tool go twice around an upright circle of 0.1 m beside its measured place, in place of working with
    /// somebody. The workspace of the settings must be narrow.
    #[must_use]
    pub fn circling(self) -> Self {
        Self { circles: true, ..self }
    }

    /// Returns the faults so far.
    pub fn faults(&self) -> &FaultLog {
        &self.faults
    }

    /// Returns the means to acknowledge stops from another thread.
    pub fn acknowledgement(&self) -> Acknowledgement {
        self.law.acknowledgement()
    }
}

impl<F: FnMut(&str)> ControlLaw for AnnouncedLaw<F> {
    type Error = Error;

    fn begin(&mut self, measured: &JointMeasurement) -> Result<(), Error> {
        self.law.begin(measured)?;
        if self.circles {
            let controller = self.law.controller_mut().controller_mut();
            circle(controller, &measured.position)?;
        }
        if !self.law.controller().measures_contacts() {
            (self.tell)(
                "the robot measures no torques of its arm: nothing is felt, so force limiting is off, and the robot \
                 keeps its protective distance from everybody, those included with whom it works",
            );
        }
        if self.law.takes_object() && measured.robot.holds.is_none() {
            (self.tell)(
                "the robot has not said yet whether its gripper holds something: it takes no object until then",
            );
        }
        if measured.robot.mode.is_none() {
            (self.tell)(
                "the robot does not say whether it takes commands: a stop of its own is noticed only when it does \
                 not follow",
            );
        }
        Ok(())
    }

    fn step(
        &mut self,
        now: f64,
        measured: &JointMeasurement,
        command: &mut JointCommand,
    ) -> Result<(), Error> {
        let begun = Instant::now();
        let stepped = self.law.step(now, measured, command);
        let controller = self.law.controller().controller();
        self.faults.push(now, controller.command().fault);
        self.ticks.send(now, controller, &measured.position, 1e6 * begun.elapsed().as_secs_f64());
        stepped
    }

    fn perception_age(&self) -> Option<f64> {
        self.law.perception_age()
    }

    fn request_stop(&mut self) {
        self.law.request_stop();
    }

    fn is_at_rest(&self, measured: &JointMeasurement) -> Option<bool> {
        self.law.is_at_rest(measured)
    }

    fn longest_interval(&self) -> Option<f64> {
        self.law.longest_interval()
    }

    fn measurement_age(&self, measured: &JointMeasurement) -> f64 {
        self.law.measurement_age(measured)
    }
}
