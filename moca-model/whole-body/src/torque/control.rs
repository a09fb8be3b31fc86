//! Torque control of a robot that follows velocities.

use super::impedance::{ImpedanceSettings, JointImpedance, JointState};
use super::measurement_watch::{MeasurementFault, MeasurementWatch};
use super::prediction::StatePrediction;
use super::resynchronisation::{Following, Resynchronisation};
use super::support::{Compensation, SupportTorque, SupportedMotion};
use crate::error::{Error, check_finite};
use crate::ik::following_error::FollowingErrorLimit;
use crate::robot::joint::JointKind;
use crate::robot::model::Model;
use crate::state::data::Data;

/// Settings of a [`TorqueControl`]. They have no default, because the compensation of the robot itself must be stated.
#[derive(Debug, Clone, PartialEq)]
pub struct TorqueSettings {
    /// The joints with torque drives, in the order of q; an empty list means all. Default empty.
    pub joints: Vec<String>,
    /// The side that compensates gravity, Coriolis forces and friction.
    pub compensation: Compensation,
    /// Inertia of the rotors at these joints \[kg m²\], which is not part of the robot's mass matrix. Default 0.1, as
    /// in MuJoCo Menagerie's Panda.
    pub rotor_inertia: f64,
    /// Gains of these joints, and the torque rate. The default is a Panda's.
    pub impedance: ImpedanceSettings,
    /// Largest following errors. Beyond them the desired state restarts from the measured one. The default is that of
    /// [`FollowingErrorLimit`], 0.1 rad or m.
    pub following_error: FollowingErrorLimit,
}

impl TorqueSettings {
    /// Creates settings with a Panda's gains for all joints and an interface with this compensation.
    pub fn new(compensation: Compensation) -> Self {
        Self {
            joints: Vec::new(),
            compensation,
            rotor_inertia: 0.1,
            impedance: ImpedanceSettings::default(),
            following_error: FollowingErrorLimit::default(),
        }
    }
}

/// Turns velocities into torques by [`JointImpedance`] with gravity compensation. The desired state stays near the
/// measured one even if the robot is held ([`Resynchronisation`]).
///
/// Each tick takes q̇*, from an [`Ik`](crate::Ik) for example, and the measured state. q* is the integral of q̇* within
/// the following-error limit of q. When the following-error limit is reached, q* is set to q until the caller, who is
/// told so, has brought q̇* to rest. The desired position of other joints, such as those of a base that takes
/// velocities, is the measured one. Torque limits are the model's efforts.
///
/// Between measurements the state is predicted ([`StatePrediction`]). Springs and dampers fade with the age of the
/// measurement, until the robot only supports itself and comes to rest. Missing or frozen measurements are a
/// [`fault`](Self::fault). After construction nothing allocates, unless an error is returned.
///
/// ```
/// use whole_body::{
///     Ik, tasks::PostureTask,
///     torque::{Compensation, Following, JointState, TorqueControl, TorqueSettings},
/// };
/// # use whole_body::torque::ImpedanceSettings;
/// # use whole_body::{Description, Model};
/// # let model = Model::from_urdf(r#"<robot name="one"><link name="base"/>
/// #   <link name="tip"><inertial><origin xyz="0 0 0.2"/><mass value="2"/>
/// #   <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
/// #   <joint name="hinge" type="revolute"><parent link="base"/><child link="tip"/><axis xyz="0 1 0"/>
/// #   <limit lower="-1" upper="1" velocity="1" effort="50"/></joint></robot>"#, &Description::default())?;
/// let settings = TorqueSettings {
///     impedance: ImpedanceSettings {
///         stiffness: vec![400.0],
///         damping: vec![20.0],
///         torque_rate: 1000.0,
///     },
///     ..TorqueSettings::new(Compensation::BARE)
/// };
/// let (q, v) = ([0.1], [0.0]); // measured
/// let mut control = TorqueControl::new(&model, settings, &q)?;
/// let mut builder = Ik::builder(&model);
/// builder.push("posture", PostureTask::new());
/// let mut ik = builder.build_at(&q)?;
/// for _ in 0..10 {
///     // Each millisecond:
///     let velocity = match control.following() {
///         Following::Follows => ik.step(control.desired(), 1e-3)?.velocity(),
///         _ => ik.brake(1e-3)?,
///     };
///     let torque = control.step(velocity, JointState { position: &q, velocity: &v }, 0.0, 1e-3)?;
///     assert!((torque[0] + 2.0 * 9.81 * 0.2 * 0.1_f64.sin()).abs() < 1e-9); // carries itself
/// }
/// # Ok::<(), whole_body::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct TorqueControl {
    model: Model,
    data: Data,
    /// Entries of q and q̇ of each joint with a torque drive.
    joints: Vec<(usize, usize)>,
    impedance: JointImpedance,
    support: SupportTorque,
    watch: MeasurementWatch,
    /// State prediction of the joints with torque drives.
    prediction: StatePrediction,
    resynchronisation: Resynchronisation,
    following: Following,
    /// q*.
    desired: Vec<f64>,
    /// Predicted state of the whole robot.
    position: Vec<f64>,
    velocity: Vec<f64>,
    acceleration: Vec<f64>,
    /// q̇* of the last tick.
    commanded: Vec<f64>,
    room: Gathered,
}

/// Inputs of the impedance law, one element for each joint with a torque drive.
#[derive(Debug, Clone)]
struct Gathered {
    desired: Vec<f64>,
    desired_velocity: Vec<f64>,
    measured: Vec<f64>,
    measured_velocity: Vec<f64>,
    commanded: Vec<f64>,
    support: Vec<f64>,
}

impl TorqueControl {
    /// Creates a controller for a robot at rest at the `measured` configuration.
    ///
    /// # Errors
    /// [`Error::UnknownName`], [`Error::Unsuitable`] for a joint that torque cannot drive; [`Error::UnknownEffort`];
    /// those of [`JointImpedance::new`]; [`Error::Value`] for a following-error limit out of range; those of
    /// [`Data::pose`] on the configuration.
    pub fn new(model: &Model, settings: TorqueSettings, measured: &[f64]) -> Result<Self, Error> {
        model.check_configuration(measured)?;
        let joints = joints(model, &settings.joints)?;
        joints.iter().try_for_each(|(_, entry)| model.expect_effort(*entry))?;
        let limits: Vec<_> = joints.iter().map(|(_, entry)| model.limits()[*entry]).collect();
        let none = vec![0.0; joints.len()];
        let all = vec![0.0; model.velocity_count()];
        let position: Vec<_> = joints.iter().map(|(position, _)| measured[*position]).collect();
        let driven: Vec<_> = (0..joints.len()).collect();
        Ok(Self {
            data: Data::new(model),
            impedance: JointImpedance::new(settings.impedance, &limits)?,
            support: SupportTorque::new(model, settings.compensation, settings.rotor_inertia)?,
            watch: MeasurementWatch::new(joints.len()),
            prediction: StatePrediction::new(&position, &driven),
            position: measured.to_vec(),
            velocity: all.clone(),
            acceleration: all.clone(),
            commanded: all,
            resynchronisation: Resynchronisation::of_model(model, &settings.following_error)?,
            following: Following::Follows,
            desired: measured.to_vec(),
            room: Gathered {
                desired: none.clone(),
                desired_velocity: none.clone(),
                measured: none.clone(),
                measured_velocity: none.clone(),
                commanded: none.clone(),
                support: none,
            },
            model: model.clone(),
            joints,
        })
    }

    /// Computes the torques for the next `period` \[s\], one for each joint with a torque drive \[Nm or N\].
    ///
    /// q̇* is `velocity`. The state, q and q̇ of the whole robot, was measured `age` \[s\] ago. The age is the time
    /// since the measurement came plus the known part of its delay beyond one period.
    ///
    /// # Errors
    /// [`Error::WrongSize`]; [`Error::Value`] for states and the period. No torque is then sent, and the desired state
    /// is unchanged.
    pub fn step(
        &mut self,
        velocity: &[f64],
        measured: JointState<'_>,
        age: f64,
        period: f64,
    ) -> Result<&[f64], Error> {
        check_finite(period, || "the time step [s]".to_owned())?;
        if period <= 0.0 {
            return Err(Error::not_positive("the time step [s]", period));
        }
        self.model.check_velocity("q̇*", velocity)?;
        self.model.check_velocity("q̇", measured.velocity)?;
        self.model.check_configuration(measured.position)?;
        self.predict(&measured, age, period)?;
        let rests = velocity.iter().all(|velocity| *velocity == 0.0);
        // The desired state restarts from the measured one, so that no error of the time without measurements is
        // corrected.
        let restarts = self.prediction.is_recovering() && self.resynchronisation.restart();
        self.following = self.resynchronisation.clamp(&mut self.desired, &self.position, rests)?;
        // A short gap is no reason to come to rest.
        if restarts && self.watch.fault().is_none() {
            self.following = Following::Follows;
        }
        self.advance(velocity, period);
        self.support(velocity)?;
        self.gather(velocity);
        self.commanded.copy_from_slice(velocity);
        let room = &self.room;
        let desired = JointState { position: &room.desired, velocity: &room.desired_velocity };
        let state = JointState { position: &room.measured, velocity: &room.measured_velocity };
        self.impedance.limit_rate(self.prediction.rate_limit());
        self.impedance.torque(desired, state, &room.support, period)
    }

    /// Predicts the present state from the measurements.
    fn predict(&mut self, measured: &JointState<'_>, age: f64, period: f64) -> Result<(), Error> {
        let Self { room, joints, watch, prediction, .. } = self;
        for (joint, (position, entry)) in joints.iter().enumerate() {
            room.measured[joint] = measured.position[*position];
            room.measured_velocity[joint] = measured.velocity[*entry];
            room.commanded[joint] = self.commanded[*entry];
        }
        let state = JointState { position: &room.measured, velocity: &room.measured_velocity };
        let age = watch.update(state, &room.commanded, age, period);
        prediction.update(state, &room.commanded, age, watch.awaited(), period)?;
        self.position.copy_from_slice(measured.position);
        self.velocity.copy_from_slice(measured.velocity);
        for (joint, (position, entry)) in joints.iter().enumerate() {
            self.position[*position] = prediction.position()[joint];
            self.velocity[*entry] = prediction.velocity()[joint];
            self.acceleration[*entry] = prediction.acceleration()[joint];
        }
        Ok(())
    }

    /// Advances q* by q̇* for joints with torque drives.
    fn advance(&mut self, velocity: &[f64], period: f64) {
        let mut driven = self.joints.iter().peekable();
        for (index, (desired, now)) in self.desired.iter_mut().zip(&self.position).enumerate() {
            match driven.next_if(|(position, _)| *position == index) {
                Some((_, entry)) => *desired += velocity[*entry] * period,
                None => *desired = *now,
            }
        }
    }

    /// Computes the torques beside springs and dampers.
    fn support(&mut self, commanded: &[f64]) -> Result<(), Error> {
        let motion = SupportedMotion {
            position: &self.position,
            velocity: &self.velocity,
            acceleration: &self.acceleration,
            commanded,
            share: 1.0 - self.prediction.weight(),
        };
        self.support.update(&mut self.data, &self.model, &motion)?;
        Ok(())
    }

    fn gather(&mut self, velocity: &[f64]) {
        let Self { room, prediction, support, .. } = self;
        for (joint, (position, entry)) in self.joints.iter().enumerate() {
            let (now, moving) = (prediction.position()[joint], prediction.velocity()[joint]);
            room.measured[joint] = now;
            room.measured_velocity[joint] = moving;
            room.desired[joint] = prediction.towards(self.desired[*position], now);
            room.desired_velocity[joint] = prediction.towards(velocity[*entry], moving);
            room.support[joint] = support.torque()[*entry];
        }
    }

    /// The fault of the measurements. Bring q̇* to rest then, and end the loop unless they recover.
    pub fn fault(&self) -> Option<MeasurementFault> {
        self.watch.fault()
    }

    /// Whether the robot followed in the last tick. If it does not, bring q̇* to rest.
    pub fn following(&self) -> Following {
        self.following
    }

    /// q*, a whole q, at which tasks are to be computed.
    pub fn desired(&self) -> &[f64] {
        &self.desired
    }

    /// Restarts q* from q as at the following-error limit. The robot yields until q̇* has come to rest.
    pub fn give_way(&mut self) {
        self.resynchronisation.resynchronise();
        self.following = Following::Resynchronising;
    }
}

/// Returns the entries of q and q̇ of joints by name, in the order of q.
pub(crate) fn joints(model: &Model, names: &[String]) -> Result<Vec<(usize, usize)>, Error> {
    let mut ids: Vec<_> = model.joint_ids().collect();
    if !names.is_empty() {
        let named: Vec<_> =
            names.iter().map(|name| model.joint_id(name)).collect::<Result<_, _>>()?;
        ids.retain(|id| named.contains(id));
    }
    let joints = ids.into_iter().map(|id| {
        let joint = model.joint(id)?;
        if joint.kind == JointKind::Floating {
            return Err(Error::floating_joint(&joint.name));
        }
        Ok((joint.position_index, joint.velocity_index))
    });
    joints.collect()
}
