//! The controller in a loop of its own, with percepts from another thread.

use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

use whole_body::{ControlLaw, JointCommand, JointMeasurement};

use crate::camera_frame::CameraFrame;
use crate::error::Error;
use crate::torque::{Measured, TorqueController};

/// Camera frames that may wait for the next tick: more than come within one.
const WAITING: usize = 8;

/// [`TorqueController`] as the law of a [`ControlLoop`](whole_body::ControlLoop).
///
/// Camera frames come from another thread, by a channel that never makes the loop wait; their times are on the clock
/// of the loop. Commands hold q* and q̇* of all joints and the torques of those that take them.
///
/// ```
/// use ergo_map::ErgonomicsQuadratic;
/// use moca_model::whole_body::{ControlLaw, JointCommand, JointMeasurement};
/// use moca_model::{
///     Controller, ControllerSettings, LoopController, MOCA_HOME, TorqueController, TorqueLoopSettings, moca,
/// };
/// use nalgebra::{Matrix3, Vector3};
///
/// let comfort = ErgonomicsQuadratic::new(Matrix3::identity(), Vector3::zeros(), 1.0)?;
/// let controller = Controller::new(moca()?, comfort, ControllerSettings::default(), &MOCA_HOME)?;
/// let controller = TorqueController::new(controller, TorqueLoopSettings::default())?;
/// let (mut law, frames) = LoopController::new(controller);
/// // The thread of the camera: frames.try_send(CameraFrame::from(percept)). The loop, each millisecond:
/// let mut measured = JointMeasurement::resting(MOCA_HOME.to_vec(), 10);
/// measured.torque.fill(Some(0.0));
/// let mut command = JointCommand::at_rest(&measured);
/// law.step(0.001, &measured, &mut command)?;
/// assert!((command.torque[6] - 22.0).abs() < 0.5); // Nm carry the forearm
/// # drop(frames);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct LoopController {
    controller: TorqueController,
    frames: Receiver<CameraFrame>,
    stops: bool,
}

impl LoopController {
    /// With a controller that has not made a step yet; and where its camera frames go.
    pub fn new(controller: TorqueController) -> (Self, SyncSender<CameraFrame>) {
        let (sender, frames) = sync_channel(WAITING);
        (Self { controller, frames, stops: false }, sender)
    }

    /// The controller.
    pub fn controller(&self) -> &TorqueController {
        &self.controller
    }

    /// The same, to place the workspace and to acknowledge stops.
    pub fn controller_mut(&mut self) -> &mut TorqueController {
        &mut self.controller
    }
}

impl ControlLaw for LoopController {
    type Error = Error;

    fn begin(&mut self, measured: &JointMeasurement) -> Result<(), Error> {
        let JointMeasurement { position, velocity, torque, age, .. } = measured;
        self.controller.begin(&Measured { position, velocity, torque, age: *age })
    }

    fn step(
        &mut self,
        now: f64,
        measured: &JointMeasurement,
        command: &mut JointCommand,
    ) -> Result<(), Error> {
        while let Ok(frame) = self.frames.try_recv() {
            // A frame that counts as no data, or shows too many people, is a fault, which the supervisor knows.
            match self.controller.observe_people(&frame.percept, frame.others()) {
                Ok(())
                | Err(Error::Frame { .. } | Error::Body { .. } | Error::TooManyPeople { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        if self.stops {
            // Nobody can acknowledge a stop that is asked for in every tick.
            self.controller.controller_mut().request_stop();
        }
        let JointMeasurement { position, velocity, torque, age, .. } = measured;
        let measured = Measured { position, velocity, torque, age: *age };
        let told = self.controller.step(now, &measured)?;
        command.position.copy_from_slice(&told.joint_position);
        command.velocity.copy_from_slice(&told.joint_velocity);
        for (joint, torque) in self.controller.joints().iter().zip(self.controller.torque()) {
            if let Some(place) = command.torque.get_mut(*joint) {
                *place = *torque;
            }
        }
        Ok(())
    }

    fn perception_age(&self) -> Option<f64> {
        Some(self.controller.controller().clock().age().seconds())
    }

    fn request_stop(&mut self) {
        self.stops = true;
    }

    fn is_at_rest(&self) -> bool {
        self.controller.controller().command().joint_velocity.iter().all(|speed| *speed == 0.0)
    }
}
