//! A controller with torques for the arm, velocities for the base, and supervision of external forces.

mod sensing;

use hrsw_safety::SafetyState;
use nalgebra::Vector3;
use whole_body::Model;
use whole_body::control_loop::JointMeasurement;
use whole_body::state::{Payload, PayloadId};
use whole_body::torque::{ContactForce, JointState, MomentumObserver, ObserverSettings, TorqueLaw};

use super::payload_watch::PayloadWatch;
use super::settings::{AnswerDelay, TorqueLoopSettings};
use crate::command::Command;
use crate::controller::Controller;
use crate::error::Error;
use crate::grasped_object::GraspedObject;
use crate::scene::Scene;
use sensing::Usable;

/// A [`Controller`] down to torque. The arm gets the torques of a [`TorqueLaw`] that follows its commands, the base
/// velocities.
///
/// Tasks are computed at the commanded arm and base. The arm's q* is within the following-error limit of q, and the
/// base approaches its measured place. So the arm's spring and damper do not form a feedback loop with the
/// tasks. The tool corrects for the true place of the base.
///
/// A [`MomentumObserver`] estimates the external torque. The force at the tool that explains it goes to the supervisor
/// each tick. Above its limit the robot stops and yields: q* is q until the force is gone.
///
/// ```
/// use ergo_map::ErgonomicsQuadratic;
/// use moca_model::whole_body::{control_loop::JointMeasurement, torque::Compensation};
/// use moca_model::{
///     Controller, ControllerSettings, MOCA_HOME, TorqueController, TorqueLoopSettings, moca,
/// };
/// use nalgebra::{Matrix3, Vector3};
///
/// let ergonomics = ErgonomicsQuadratic::new(Matrix3::identity(), Vector3::new(-0.4, 0.1, -1.1), 0.8)?;
/// let controller = Controller::new(moca()?, ergonomics, ControllerSettings::default(), &MOCA_HOME)?;
/// let mut controller = TorqueController::new(controller, TorqueLoopSettings::new(Compensation::BARE))?;
/// // In the loop: controller.observe(&percept) at each camera frame, and each millisecond
/// let mut measured = JointMeasurement::resting(MOCA_HOME.to_vec(), 10);
/// measured.torque.fill(Some(0.0));
/// let command = controller.step(0.001, &measured)?;
/// let [_forward, _left, _turn] = command.base_twist; // to the base
/// assert!(controller.torque()[3] > 20.0); // Nm, to the arm: the elbow carries itself
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct TorqueController {
    controller: Controller,
    settings: TorqueLoopSettings,
    law: TorqueLaw,
    /// Entries of q̇ of the joints with torque drives.
    joints: Vec<usize>,
    observer: MomentumObserver,
    contact: ContactForce,
    force: Vector3<f64>,
    /// True if the last torques of all joints with torque drives were measured.
    measures_force: bool,
    /// Last usable measurement.
    position: Vec<f64>,
    velocity: Vec<f64>,
    /// True if the measurements of the last tick were faulty.
    is_lost: bool,
    /// Place where an arm waits before its first motion, and whether it does.
    rest: Vec<f64>,
    waits: bool,
    /// Time of the last tick, and the time between the last two ticks \[s\].
    last: Option<f64>,
    elapsed: f64,
    /// Time since the observer's last update \[s\].
    unobserved: f64,
    payload_watch: PayloadWatch,
    unknown_payload: Option<f64>,
    /// The payload of the grasped object.
    grasped: Option<PayloadId>,
    /// Measured torques of the joints with torque drives \[N or Nm\].
    sensed: Vec<f64>,
    /// Additional deflection of the springs that compensates their sag \[rad\].
    sag: Vec<f64>,
    /// The configuration that the springs pull to.
    desired: Vec<f64>,
}

/// Rate of the observer of external torques \[1/s\]: a collision shows after 20 ms, and the sensors' noise is averaged.
const OBSERVER_RATE: f64 = 50.0;
/// Rate at which the sag of springs is learnt \[1/s\]: slow for the arm, fast for a working person.
const SAG_RATE: f64 = 2.0;
/// Largest compensated sag \[rad\].
const LARGEST_SAG: f64 = 0.03;
/// Share of the gains of an arm that waits, low enough for any delay.
const SOFT: f64 = 0.04;
/// Speed up to which joints count as at rest \[m/s or rad/s\]. It covers sensor noise and creep in friction.
const AT_REST: f64 = 0.02;

impl TorqueController {
    /// Creates the torque control of a controller that has not made a step.
    ///
    /// # Errors
    /// Settings out of range, or joints that the robot does not have.
    pub fn new(mut controller: Controller, settings: TorqueLoopSettings) -> Result<Self, Error> {
        settings.validate()?;
        let robot = controller.robot();
        let (model, tool) = (robot.model(), robot.tool());
        let position = controller.command().joint_position.clone();
        let names = &settings.joints;
        let mut law = TorqueLaw::new(model, settings.law(), &position)?;
        let observer = ObserverSettings {
            joints: names.clone(),
            rates: vec![OBSERVER_RATE; names.len()],
            friction: settings.friction,
        };
        let observer = MomentumObserver::new(model, observer)?;
        let contact = ContactForce::new(model, tool, names)?;
        let joints: Vec<_> = law.joints().iter().map(|(_, entry)| *entry).collect();
        controller.follow_positions(&joints);
        if let AnswerDelay::Known(delay) = settings.delay {
            law.set_delay(delay);
        }
        let none = vec![0.0; joints.len()];
        Ok(Self {
            law,
            observer,
            contact,
            force: Vector3::zeros(),
            measures_force: false,
            velocity: vec![0.0; position.len()],
            is_lost: false,
            rest: position.clone(),
            waits: false,
            last: None,
            elapsed: controller.settings().period,
            unobserved: 0.0,
            payload_watch: PayloadWatch::default(),
            unknown_payload: None,
            grasped: None,
            sensed: none.clone(),
            sag: none,
            desired: position.clone(),
            position,
            joints,
            controller,
            settings,
        })
    }

    /// Makes a tick before the first motion. The arm is held in place by soft springs, and one joint is pushed \[Nm\].
    pub(super) fn wait(&mut self, measured: &JointMeasurement, (pushed, torque): (usize, f64)) {
        let usable = self.take(measured);
        self.predict(measured.age);
        self.sense_force(usable);
        if !self.waits {
            self.rest.copy_from_slice(self.law.state().position);
            self.waits = true;
        }
        self.law.push(pushed, torque);
        // The command is at rest before the first motion.
        let velocity = &self.controller.command().joint_velocity;
        let desired = JointState { position: &self.rest, velocity };
        // If a number is not finite, the torque stays.
        let _ = self.law.step(desired, [SOFT; 2], self.period());
    }

    /// Writes the torques of the joints with torque drives into those of all joints.
    pub(crate) fn write_torques(&self, all: &mut [f64]) {
        for (joint, torque) in self.joints.iter().zip(self.torque()) {
            if let Some(place) = all.get_mut(*joint) {
                *place = *torque;
            }
        }
    }

    /// The settings.
    pub fn settings(&self) -> &TorqueLoopSettings {
        &self.settings
    }

    pub(super) fn period(&self) -> f64 {
        self.controller.settings().period
    }

    /// True if the robot is measured at rest and commanded to stay there; `None` if that is not known.
    pub fn is_at_rest(&self) -> Option<bool> {
        let is_told = self.controller.command().joint_velocity.iter().all(|speed| *speed == 0.0);
        let is_measured = self.velocity.iter().all(|speed| speed.abs() <= AT_REST);
        (!self.is_lost).then_some(is_told && is_measured)
    }

    /// The torque law of the arm, with the age of the measured state.
    pub fn law(&self) -> &TorqueLaw {
        &self.law
    }

    /// The torque law of the arm, to set the delay of measurements.
    pub fn law_mut(&mut self) -> &mut TorqueLaw {
        &mut self.law
    }

    /// Takes a camera frame; see [`Controller::observe`].
    ///
    /// # Errors
    /// Those of [`Controller::observe`].
    pub fn observe(&mut self, scene: impl Into<Scene>) -> Result<(), Error> {
        self.controller.observe(scene)
    }

    /// Takes the first measurement of a robot, before the first step. [`measures_contacts`](Self::measures_contacts) is
    /// known afterwards.
    ///
    /// # Errors
    /// [`Error::Robot`] for a state far beyond the limits, which must be in other units. It names the joint.
    pub fn begin(&mut self, measured: &JointMeasurement) -> Result<(), Error> {
        self.model().check_units(&measured.position, &measured.velocity)?;
        self.measures_force = self.measures_torques(measured);
        Ok(())
    }

    /// True if contacts would be noticed, because the last torques of all joints with torque drives were measured.
    /// Otherwise force limiting is off and nobody may be touched. The robot then keeps the same distance from its
    /// partner as from others.
    pub fn measures_contacts(&self) -> bool {
        self.measures_force
    }

    fn measures_torques(&self, measured: &JointMeasurement) -> bool {
        let known = |joint: &usize| measured.torque.get(*joint).is_some_and(Option::is_some);
        self.joints.iter().all(known)
    }

    /// Computes the command for the period that begins at `now` \[s\], with the robot as `measured`. The torques of the
    /// arm are [`torque`](Self::torque). Allocates nothing.
    ///
    /// Between measurements the state is predicted ([`StatePrediction`](whole_body::torque::StatePrediction)). Spring and damper act on the prediction, and
    /// fade with its age until the arm only supports itself. A measurement that is missing for 6 to 8 ms or frozen
    /// ([`MeasurementWatch`](whole_body::torque::MeasurementWatch)) is a [`Fault::MissingMeasurement`](hrsw_safety::Fault::MissingMeasurement) or
    /// [`Fault::FrozenMeasurement`](hrsw_safety::Fault::FrozenMeasurement).
    ///
    /// A measurement with any unusable number is a [`Fault::BadMeasurement`](hrsw_safety::Fault::BadMeasurement), and
    /// the command brakes. Joints without a position are moved on by their velocities. If velocities are missing too,
    /// the arm has no spring and supports itself at the last measured position. A missing velocity removes the damper.
    /// If torques are not measured, contacts are not noticed, so that nobody may be touched.
    ///
    /// # Errors
    /// [`Error::Size`] for a configuration of the wrong size, as [`Controller::step`].
    pub fn step(&mut self, now: f64, measured: &JointMeasurement) -> Result<&Command, Error> {
        let usable = self.take(measured);
        let last = self.last.replace(now);
        self.elapsed = self.time_since(last, now);
        self.predict(measured.age);
        self.sense_force(usable);
        let JointState { position, velocity } = self.law.state();
        let configuration = if usable.position { position } else { &measured.position };
        self.controller.set_measured_velocity(if usable.velocity { velocity } else { &[] });
        let outcome = self.controller.step(now, configuration).map(|_| ());
        self.follow(usable);
        outcome.map(|()| self.controller.command())
    }

    /// The time since the last tick \[s\]; a period if the clock's time is invalid.
    fn time_since(&self, last: Option<f64>, now: f64) -> f64 {
        let elapsed = last.map_or(self.period(), |last| now - last);
        let longest = self.controller.clock().longest_gap();
        if elapsed > 0.0 && elapsed <= longest { elapsed } else { self.period() }
    }

    /// Computes the torques towards the command. Unknown positions remove the spring, and unknown velocities the damper.
    fn follow(&mut self, usable: Usable) {
        self.desired.copy_from_slice(&self.controller.command().joint_position);
        self.learn_sag(usable);
        for (joint, sag) in self.joints.iter().zip(&self.sag) {
            if let Some(desired) = self.desired.get_mut(*joint) {
                *desired += sag;
            }
        }
        let velocity = &self.controller.command().joint_velocity;
        let desired = JointState { position: &self.desired, velocity };
        let share = |is_known: bool| if is_known { self.law.weight() } else { 0.0 };
        let shares = [share(usable.position || usable.velocity), share(usable.velocity)];
        // If a number is not finite, the torque stays.
        let _ = self.law.step(desired, shares, self.period());
    }

    /// Learns the sag of the springs slowly. It is kept during a stop, and reset while the arm yields.
    fn learn_sag(&mut self, usable: Usable) {
        let supervisor = self.controller.safety().supervisor();
        if supervisor.gives_way() {
            self.sag.fill(0.0);
        }
        let stops = supervisor.state() == SafetyState::ProtectiveStop;
        if stops || self.is_lost || !usable.position {
            return;
        }
        let share = (self.elapsed * SAG_RATE).min(1.0);
        let present = self.law.state().position;
        for (sag, joint) in self.sag.iter_mut().zip(&self.joints) {
            if let (Some(desired), Some(now)) = (self.desired.get(*joint), present.get(*joint)) {
                *sag = (*sag + share * (desired - now)).clamp(-LARGEST_SAG, LARGEST_SAG);
            }
        }
    }

    /// The joints with torque drives, as indices of q̇.
    pub fn joints(&self) -> &[usize] {
        &self.joints
    }

    /// The torques of the joints with torque drives, in the order of q \[Nm\]. Before the first step they support the
    /// arm.
    pub fn torque(&self) -> &[f64] {
        self.law.torque()
    }

    /// The undeclared mass at the tool, while there is a [`Fault::UnknownPayload`](hrsw_safety::Fault::UnknownPayload)
    /// \[kg\].
    pub fn unknown_payload(&self) -> Option<f64> {
        self.unknown_payload
    }

    /// The estimated external force at the tool \[N, world\].
    pub fn external_force(&self) -> &Vector3<f64> {
        &self.force
    }

    /// Sets the object that the tool holds, as [`Controller::grasp`]. Gravity and observer include it.
    ///
    /// # Errors
    /// Those of [`Controller::grasp`].
    pub fn grasp(&mut self, object: GraspedObject) -> Result<(), Error> {
        let payload = object.payload(self.controller.robot().tool());
        self.controller.grasp(object)?;
        self.let_go()?;
        self.grasped = Some(self.attach(&payload)?);
        Ok(())
    }

    /// Releases the grasped object and returns it.
    ///
    /// # Errors
    /// Never.
    pub fn release(&mut self) -> Result<Option<GraspedObject>, Error> {
        self.let_go()?;
        self.controller.release()
    }

    fn let_go(&mut self) -> Result<(), Error> {
        self.grasped.take().map_or(Ok(()), |payload| self.detach(payload))
    }

    /// Attaches a payload, which gravity and observer include.
    ///
    /// # Errors
    /// [`Error::Robot`], as [`Data::attach`](whole_body::Data::attach).
    pub fn attach(&mut self, payload: &Payload) -> Result<PayloadId, Error> {
        Ok(self.law.data_mut().attach(self.controller.robot().model(), payload)?)
    }

    /// Detaches a payload.
    ///
    /// # Errors
    /// [`Error::Robot`], as [`Data::detach`](whole_body::Data::detach).
    pub fn detach(&mut self, payload: PayloadId) -> Result<(), Error> {
        Ok(self.law.data_mut().detach(self.controller.robot().model(), payload)?)
    }

    /// The controller of velocities.
    pub fn controller(&self) -> &Controller {
        &self.controller
    }

    /// The controller of velocities, to place the workspace and to acknowledge stops.
    pub fn controller_mut(&mut self) -> &mut Controller {
        &mut self.controller
    }

    /// The robot.
    pub fn model(&self) -> &Model {
        self.controller.robot().model()
    }
}
