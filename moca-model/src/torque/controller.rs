//! Torques for the arm, velocities for the base, and a supervisor that feels who pushes.

use hrsw::Fault;
use nalgebra::Vector3;
use vision_models::{Body, Percept};
use whole_body::{
    ContactForce, Data, JointImpedance, JointState, Model, MomentumObserver, ObserverSettings,
    Payload, PayloadId,
};

use super::settings::TorqueLoopSettings;
use crate::command::Command;
use crate::controller::Controller;
use crate::error::Error;
use crate::held_object::HeldObject;

/// What a robot measures each tick, n of each, in the order of q.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured<'a> {
    /// q \[m or rad\].
    pub position: &'a [f64],
    /// q̇ \[m/s or rad/s\]; the base's x and y in the world's axes.
    pub velocity: &'a [f64],
    /// The torques that act on the links, behind the gears \[N or Nm\], none where they are not measured; only
    /// those of the joints driven by torque are read.
    pub torque: &'a [Option<f64>],
    /// How long ago it was measured \[s\].
    pub age: f64,
}

/// A [`Controller`] down to torque: τ = `K_d` (q̇* − q̇) + `K_p` (q* − q) + g(q) for the arm, within torque
/// and torque-rate limits, and velocities for the base.
///
/// Tasks are computed with the base where it is measured and the arm where it is commanded, q* being
/// within the leash of q: so the arm's spring and damper do not close a loop with the tasks, and the tool
/// makes up for where the base really is. The torque from outside comes of a [`MomentumObserver`], the
/// force at the tool that explains it goes to the supervisor each tick. Above its limit the robot stops,
/// and gives way: q* is q until the force is gone.
///
/// ```
/// use ergo_map::ErgonomicsQuadratic;
/// use moca_model::{
///     Controller, ControllerSettings, MOCA_HOME, Measured, TorqueController, TorqueLoopSettings, moca,
/// };
/// use nalgebra::{Matrix3, Vector3};
///
/// let comfort = ErgonomicsQuadratic::new(Matrix3::identity(), Vector3::new(-0.4, 0.1, -1.1), 0.8)?;
/// let controller = Controller::new(moca()?, comfort, ControllerSettings::default(), &MOCA_HOME)?;
/// let mut controller = TorqueController::new(controller, TorqueLoopSettings::default())?;
/// // In the loop: controller.observe(&percept) at each camera frame, and each millisecond
/// let measured =
///     Measured { position: &MOCA_HOME, velocity: &[0.0; 10], torque: &[Some(0.0); 10], age: 0.0 };
/// let command = controller.step(0.001, &measured)?;
/// let [_forward, _left, _turn] = command.base_twist; // to the base
/// assert!(controller.torque()[3] > 20.0); // Nm, to the arm: the elbow carries itself
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct TorqueController {
    controller: Controller,
    data: Data,
    /// The entries of q and q̇ of the joints driven by torque.
    joints: Vec<usize>,
    impedance: JointImpedance,
    observer: MomentumObserver,
    contact: ContactForce,
    force: Vector3<f64>,
    /// Whether the torques of all driven joints were measured last.
    feels: bool,
    /// As measured last, if that could be used.
    position: Vec<f64>,
    velocity: Vec<f64>,
    /// Of the whole robot.
    gravity: Vec<f64>,
    /// What the tool holds.
    held: Option<PayloadId>,
    law: LawInput,
    torque: Vec<f64>,
}

/// Which of the measurements of a tick can be used.
#[derive(Debug, Clone, Copy)]
struct Usable {
    position: bool,
    velocity: bool,
    torque: bool,
}

impl Usable {
    fn all(self) -> bool {
        self.position && self.velocity && self.torque
    }
}

/// What the law sees, one element a joint driven by torque.
#[derive(Debug, Clone)]
struct LawInput {
    desired: Vec<f64>,
    desired_velocity: Vec<f64>,
    measured: Vec<f64>,
    measured_velocity: Vec<f64>,
    gravity: Vec<f64>,
    sensed: Vec<f64>,
}

impl TorqueController {
    /// With a controller that has not made a step yet.
    ///
    /// # Errors
    /// Settings out of range, or joints that the robot does not have.
    pub fn new(mut controller: Controller, settings: TorqueLoopSettings) -> Result<Self, Error> {
        settings.validate()?;
        let robot = controller.robot();
        let (model, tool) = (robot.model().clone(), robot.tool());
        let names = &settings.joints;
        let mut joints = names
            .iter()
            .map(|name| Ok(model.joint(model.joint_id(name)?)?.velocity_index))
            .collect::<Result<Vec<_>, Error>>()?;
        joints.sort_unstable();
        controller.follow_positions(&joints);
        let limits: Vec<_> =
            joints.iter().filter_map(|joint| model.limits().get(*joint).copied()).collect();
        let observer = ObserverSettings {
            joints: names.clone(),
            rates: settings.observer_rates,
            friction: settings.friction,
        };
        let none = vec![0.0; joints.len()];
        let position = controller.command().joint_position.clone();
        let mut torque_controller = Self {
            data: Data::new(&model),
            impedance: JointImpedance::new(settings.impedance, &limits)?,
            observer: MomentumObserver::new(&model, observer)?,
            contact: ContactForce::new(&model, tool, names)?,
            force: Vector3::zeros(),
            feels: false,
            velocity: vec![0.0; position.len()],
            gravity: vec![0.0; position.len()],
            held: None,
            law: LawInput {
                desired: none.clone(),
                desired_velocity: none.clone(),
                measured: none.clone(),
                measured_velocity: none.clone(),
                gravity: none.clone(),
                sensed: none.clone(),
            },
            torque: none,
            position,
            joints,
            controller,
        };
        torque_controller.carry()?;
        torque_controller.torque.copy_from_slice(&torque_controller.law.gravity);
        Ok(torque_controller)
    }

    /// Takes a camera frame; see [`Controller::observe`].
    ///
    /// # Errors
    /// Those of [`Controller::observe`].
    pub fn observe(&mut self, percept: &Percept) -> Result<(), Error> {
        self.controller.observe(percept)
    }

    /// The same where other people are in view; see [`Controller::observe_people`].
    ///
    /// # Errors
    /// Those of [`Controller::observe_people`].
    pub fn observe_people(&mut self, percept: &Percept, others: &[Body]) -> Result<(), Error> {
        self.controller.observe_people(percept, others)
    }

    /// Takes the first measurement of a robot, before the first step; tells of it by
    /// [`feels_contacts`](Self::feels_contacts).
    ///
    /// # Errors
    /// [`Error::Robot`] for a state that the limits exclude by far: it is in other units. It names the joint.
    pub fn begin(&mut self, measured: &Measured<'_>) -> Result<(), Error> {
        self.model().check_units(measured.position, measured.velocity)?;
        self.feels = self.measures_torques(measured);
        Ok(())
    }

    /// Whether contacts would be noticed: all torques of the driven joints were measured last. Else force limiting is
    /// off: nobody may be touched, and distances are those to people with whom the robot does not work.
    pub fn feels_contacts(&self) -> bool {
        self.feels
    }

    fn measures_torques(&self, measured: &Measured<'_>) -> bool {
        let known = |joint: &usize| measured.torque.get(*joint).is_some_and(Option::is_some);
        self.joints.iter().all(known)
    }

    /// The command for the period that begins at `now` \[s\], with the robot as `measured`; the torques of
    /// the arm are [`torque`](Self::torque). Allocates nothing.
    ///
    /// Torques that are not measured are no fault: nothing is felt, and no contact permitted. A measurement of which
    /// any number cannot be used is a [`Fault::BadMeasurement`], and the command brakes. Joints without a position count as moved by their velocities since they had one. Without
    /// these too the arm has no spring, and carries itself as where it was measured last; without a velocity
    /// it has no damper.
    ///
    /// # Errors
    /// [`Error::WrongSize`] for a configuration of the wrong size, as [`Controller::step`].
    pub fn step(&mut self, now: f64, measured: &Measured<'_>) -> Result<&Command, Error> {
        let usable = self.take(measured);
        self.feels = self.measures_torques(measured);
        let felt = usable.all() && (!self.feels || self.feel().is_ok());
        if !felt {
            self.controller.report(Fault::BadMeasurement);
        }
        if !(felt && self.feels) {
            self.observer.reset();
            self.force = Vector3::zeros();
            self.carry()?;
        }
        let outcome = self.controller.step(now, measured.position).map(|_| ());
        self.write_law(usable);
        let law = &self.law;
        let desired = JointState { position: &law.desired, velocity: &law.desired_velocity };
        let state = JointState { position: &law.measured, velocity: &law.measured_velocity };
        let period = self.controller.settings().period;
        // Numbers that are no numbers leave the torque as it was.
        if let Ok(torque) = self.impedance.torque(desired, state, &law.gravity, period) {
            self.torque.copy_from_slice(torque);
        }
        outcome.map(|()| self.controller.command())
    }

    /// Takes of what is measured what can be used.
    fn take(&mut self, measured: &Measured<'_>) -> Usable {
        let Measured { position, velocity, torque, .. } = *measured;
        let driven = self.joints.iter().filter_map(|joint| torque.get(*joint).copied().flatten());
        let usable = Usable {
            position: self.controller.robot().model().is_configuration(position),
            velocity: velocity.len() == self.velocity.len()
                && velocity.iter().all(|velocity| is_sensible(*velocity)),
            torque: driven.into_iter().all(is_sensible),
        };
        if usable.velocity {
            self.velocity.copy_from_slice(velocity);
        }
        if usable.position {
            self.position.copy_from_slice(position);
        } else if usable.velocity {
            self.move_on(position);
        }
        if usable.torque {
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

    /// Finds the force from outside, and tells the supervisor.
    fn feel(&mut self) -> Result<(), Error> {
        let period = self.controller.settings().period;
        let model = self.controller.robot().model();
        let mut posed = self.data.pose(model, &self.position)?;
        posed.gravity_into(&mut self.gravity)?;
        let mut moving = posed.moving(&self.velocity)?;
        let found = self.observer.update(&mut moving, &self.law.sensed, period)?;
        self.force = self.contact.estimate(moving.posed(), found)?;
        self.controller.feel(self.force.norm());
        self.gather_gravity();
        Ok(())
    }

    /// Gravity at the last position.
    fn carry(&mut self) -> Result<(), Error> {
        let model = self.controller.robot().model();
        self.data.pose(model, &self.position)?.gravity_into(&mut self.gravity)?;
        self.gather_gravity();
        Ok(())
    }

    fn gather_gravity(&mut self) {
        for (own, joint) in self.law.gravity.iter_mut().zip(&self.joints) {
            *own = self.gravity.get(*joint).copied().unwrap_or_default();
        }
    }

    /// What the law is to see. Where the position is not known it has no spring, and where there is no
    /// velocity no damper.
    fn write_law(&mut self, usable: Usable) {
        let command = self.controller.command();
        let parts = [
            (&mut self.law.measured, &self.position),
            (&mut self.law.measured_velocity, &self.velocity),
            (&mut self.law.desired, &command.joint_position),
            (&mut self.law.desired_velocity, &command.joint_velocity),
        ];
        for (own, all) in parts {
            for (own, joint) in own.iter_mut().zip(&self.joints) {
                *own = all.get(*joint).copied().unwrap_or_default();
            }
        }
        if !(usable.position || usable.velocity) {
            self.law.desired.copy_from_slice(&self.law.measured);
        }
        if !usable.velocity {
            self.law.desired_velocity.copy_from_slice(&self.law.measured_velocity);
        }
    }

    /// The joints driven by torque, as indices of q̇.
    pub fn joints(&self) -> &[usize] {
        &self.joints
    }

    /// The torques for the joints driven by torque, in the order of q \[Nm\]; before the first step those
    /// that carry the arm.
    pub fn torque(&self) -> &[f64] {
        &self.torque
    }

    /// The torque from outside on each of these joints \[Nm\].
    pub fn external_torque(&self) -> &[f64] {
        self.observer.torque()
    }

    /// The force at the tool that explains it \[N, world\].
    pub fn external_force(&self) -> &Vector3<f64> {
        &self.force
    }

    /// The tool holds an object from now on, as [`Controller::hold`]; gravity and observer count it.
    ///
    /// # Errors
    /// Those of [`Controller::hold`].
    pub fn hold(&mut self, object: HeldObject) -> Result<(), Error> {
        let payload = object.payload(self.controller.robot().tool());
        self.controller.hold(object)?;
        self.let_go()?;
        self.held = Some(self.attach(&payload)?);
        Ok(())
    }

    /// The tool holds nothing; returns what it held.
    ///
    /// # Errors
    /// None.
    pub fn release(&mut self) -> Result<Option<HeldObject>, Error> {
        self.let_go()?;
        self.controller.release()
    }

    fn let_go(&mut self) -> Result<(), Error> {
        self.held.take().map_or(Ok(()), |payload| self.detach(payload))
    }

    /// The robot carries something from now on: gravity and observer count it.
    ///
    /// # Errors
    /// [`Error::Robot`], as [`Data::attach`].
    pub fn attach(&mut self, payload: &Payload) -> Result<PayloadId, Error> {
        Ok(self.data.attach(self.controller.robot().model(), payload)?)
    }

    /// It does not any more.
    ///
    /// # Errors
    /// [`Error::Robot`], as [`Data::detach`].
    pub fn detach(&mut self, payload: PayloadId) -> Result<(), Error> {
        Ok(self.data.detach(self.controller.robot().model(), payload)?)
    }

    /// The controller of velocities.
    pub fn controller(&self) -> &Controller {
        &self.controller
    }

    /// The same, to place the workspace and to acknowledge stops.
    pub fn controller_mut(&mut self) -> &mut Controller {
        &mut self.controller
    }

    /// The robot.
    pub fn model(&self) -> &Model {
        self.controller.robot().model()
    }
}

/// Numbers above this are refused, as by [`Model::is_configuration`].
const LARGEST: f64 = 1e12;

fn is_sensible(value: f64) -> bool {
    value.abs() <= LARGEST
}
