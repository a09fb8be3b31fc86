//! The controller as the law of a control loop, with percepts from another thread.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

use hrsw_safety::Fault;
use whole_body::control_loop::{ControlLaw, JointCommand, JointMeasurement, RobotStatus};

use crate::error::Error;
use crate::grasped_object::GraspedObject;
use crate::gripping::{GripTime, Gripping};
use crate::scene::Scene;
use crate::torque::start::Start;
use crate::torque::{LONGEST_INTERVAL, TorqueController};

/// Camera frames that may wait for the next tick, more than come within one.
const WAITING: usize = 8;
/// Number of refused commands in a row at which q* restarts. A single one is a common loss.
const AGAIN: u32 = 2;
/// Number of refused commands in a row that is a fault, as long as measurements may be missing.
const LOST: u32 = 6;
/// Number of refused commands in a row that counts as a stop of the robot, as of a Panda.
const REFUSED: u32 = 20;

/// [`TorqueController`] as the law of a [`ControlLoop`](whole_body::control_loop::ControlLoop).
///
/// Camera frames come from another thread through a channel that never makes the loop wait. Their times are on the
/// clock of the loop. Commands contain q* and q̇* of all joints and the torques of those that take them.
///
/// The robot stands for the first 60 ms. Its arm is held by soft springs, and the last joint with a torque drive is
/// pushed to and fro by 15 % of its effort. The delay of its response determines springs and dampers. A robot that
/// responds more than 4.5 ms late gives an [`Error::AnswersLate`]. [`AnswerDelay::Known`](crate::AnswerDelay::Known)
/// skips this.
///
/// ```
/// use ergo_map::ErgonomicsQuadratic;
/// use moca_model::whole_body::{
///     control_loop::{ControlLaw, JointCommand, JointMeasurement}, torque::Compensation,
/// };
/// use moca_model::{
///     Controller, ControllerSettings, LoopController, MOCA_HOME, TorqueController, TorqueLoopSettings, moca,
/// };
/// use nalgebra::{Matrix3, Vector3};
///
/// let ergonomics = ErgonomicsQuadratic::new(Matrix3::identity(), Vector3::zeros(), 1.0)?;
/// let controller = Controller::new(moca()?, ergonomics, ControllerSettings::default(), &MOCA_HOME)?;
/// let controller = TorqueController::new(controller, TorqueLoopSettings::new(Compensation::BARE))?;
/// let (mut law, frames) = LoopController::new(controller);
/// // The thread of the camera: frames.try_send(Scene::from(percept)). The loop, each millisecond:
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
    frames: Receiver<Scene>,
    stops: bool,
    /// The measurement of the delay, until it is known.
    start: Option<Start>,
    /// Number of commands in a row that the robot did not take.
    refused: u32,
    gripping: Option<Gripping>,
    acknowledgement: Acknowledgement,
}

/// Acknowledges the stops of a [`LoopController`] from another thread, on which the loop never waits.
#[derive(Debug, Clone, Default)]
pub struct Acknowledgement(Arc<AtomicBool>);

impl Acknowledgement {
    /// Acknowledges, in the next tick, the stop that waits for it then. Somebody has seen to the robot.
    pub fn give(&self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

impl LoopController {
    /// Creates the law from a controller that has not made a step. Also returns the sender of its camera frames.
    pub fn new(controller: TorqueController) -> (Self, SyncSender<Scene>) {
        let (sender, frames) = sync_channel(WAITING);
        let start = Start::of(&controller);
        let law = Self {
            controller,
            frames,
            stops: false,
            start,
            refused: 0,
            gripping: None,
            acknowledgement: Acknowledgement::default(),
        };
        (law, sender)
    }

    /// Lets the robot's gripper take an object, which the controller believes to be this one. Commands then say what the
    /// gripper is to do. The controller knows of the object while [`RobotStatus::holds`] is true.
    ///
    /// # Errors
    /// Those of [`GraspedObject::validate`].
    pub fn taking(mut self, object: GraspedObject, time: GripTime) -> Result<Self, Error> {
        self.gripping = Some(Gripping::new(object, time)?);
        Ok(self)
    }

    /// True if the gripper takes an object.
    pub fn takes_object(&self) -> bool {
        self.gripping.is_some()
    }

    /// The means to acknowledge stops from another thread.
    pub fn acknowledgement(&self) -> Acknowledgement {
        self.acknowledgement.clone()
    }

    /// Evaluates the status of the robot. It has stopped if it says so or takes none of many commands. Commands that it
    /// did not take are not made up for.
    fn listen(&mut self, robot: RobotStatus, is_new: bool) {
        match robot.took_command.filter(|_| is_new) {
            Some(false) => self.refused = self.refused.saturating_add(1),
            Some(true) => self.refused = 0,
            // It is not known whether the robot took the command.
            None if is_new => self.refused = 0,
            None => {}
        }
        self.controller.law_mut().set_unheard(self.refused >= AGAIN);
        if robot.is_stopped() || self.refused >= REFUSED {
            self.controller.controller_mut().robot_stopped();
        } else if self.refused >= AGAIN {
            self.controller.controller_mut().restart();
            if self.refused >= LOST {
                self.controller.controller_mut().report(Fault::LostCommand);
            }
        }
    }

    /// The controller.
    pub fn controller(&self) -> &TorqueController {
        &self.controller
    }

    /// The controller, to place the workspace and to acknowledge stops.
    pub fn controller_mut(&mut self) -> &mut TorqueController {
        &mut self.controller
    }
}

impl ControlLaw for LoopController {
    type Error = Error;

    fn begin(&mut self, measured: &JointMeasurement) -> Result<(), Error> {
        self.controller.begin(measured)
    }

    fn step(
        &mut self,
        now: f64,
        measured: &JointMeasurement,
        command: &mut JointCommand,
    ) -> Result<(), Error> {
        if let Some(start) = &mut self.start {
            if !self.stops && !start.step(&mut self.controller, measured, command)? {
                return Ok(());
            }
            self.start = None;
        }
        self.controller.controller_mut().set_present(now);
        while let Ok(frame) = self.frames.try_recv() {
            // A frame that counts as no data or shows too many people is a fault, which the supervisor knows.
            match self.controller.observe(frame) {
                Ok(())
                | Err(
                    Error::Frame { .. }
                    | Error::Body { .. }
                    | Error::Safety(
                        hrsw_safety::Error::BodySpeed { .. }
                        | hrsw_safety::Error::TooManyPeople { .. },
                    ),
                ) => {}
                Err(error) => return Err(error),
            }
        }
        if self.acknowledgement.0.swap(false, Ordering::Relaxed) {
            self.controller.controller_mut().safety_mut().supervisor_mut().acknowledge();
        }
        if let Some(gripping) = &mut self.gripping {
            command.grip = Some(gripping.advance(&mut self.controller, measured.robot.holds)?);
        }
        if self.stops {
            // Nobody can acknowledge a stop that is requested in every tick.
            self.controller.controller_mut().request_stop();
        }
        self.listen(measured.robot, measured.age <= 0.0);
        let told = self.controller.step(now, measured)?;
        command.position.copy_from_slice(&told.joint_position);
        command.velocity.copy_from_slice(&told.joint_velocity);
        self.controller.write_torques(&mut command.torque);
        Ok(())
    }

    fn perception_age(&self) -> Option<f64> {
        Some(self.controller.controller().clock().age().seconds())
    }

    fn request_stop(&mut self) {
        self.stops = true;
    }

    fn longest_interval(&self) -> Option<f64> {
        Some(LONGEST_INTERVAL)
    }

    fn measurement_age(&self, measured: &JointMeasurement) -> f64 {
        self.controller.law().age().max(measured.age)
    }

    fn is_at_rest(&self, _measured: &JointMeasurement) -> Option<bool> {
        self.controller.is_at_rest()
    }
}
