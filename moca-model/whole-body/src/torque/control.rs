//! Torques of a robot that follows velocities.

use super::impedance::{ImpedanceSettings, JointImpedance, JointState};
use super::measurement_watch::{MeasurementFault, MeasurementWatch};
use super::prediction::StatePrediction;
use super::resynchronisation::{Following, Resynchronisation};
use super::support::{Compensation, SupportTorque, SupportedMotion};
use crate::error::{Error, check_finite};
use crate::ik::leash::Leash;
use crate::robot::joint::JointKind;
use crate::robot::model::Model;
use crate::state::data::Data;

/// What a [`TorqueControl`] is made of. It has no default: somebody has to say what the robot compensates itself.
#[derive(Debug, Clone, PartialEq)]
pub struct TorqueSettings {
    /// The joints that are driven by torque, in the order of q; none for all. Default none.
    pub joints: Vec<String>,
    /// Who compensates gravity, Coriolis forces and friction.
    pub compensation: Compensation,
    /// What turns in front of the gears of these joints, seen at the joint \[kg m²\]; it is no part of the robot's mass
    /// matrix. Default 0.1, as in MuJoCo Menagerie's Panda.
    pub rotor_inertia: f64,
    /// Gains of these joints, and the torque rate. Default a Panda's.
    pub impedance: ImpedanceSettings,
    /// The largest following errors; beyond them the desired state starts anew. Default that of
    /// [`Leash`], 0.1 rad or m.
    pub leash: Leash,
}

impl TorqueSettings {
    /// A Panda's gains for all joints, on an interface with this compensation.
    pub fn new(compensation: Compensation) -> Self {
        Self {
            joints: Vec::new(),
            compensation,
            rotor_inertia: 0.1,
            impedance: ImpedanceSettings::default(),
            leash: Leash::default(),
        }
    }
}

/// Torques for velocities: the law of [`JointImpedance`] with gravity at the position, and
/// a desired state that never runs away from a robot that is held ([`Resynchronisation`]).
///
/// Between measurements the state is predicted ([`StatePrediction`]): springs and dampers fade with its age, until the
/// robot only carries itself and comes to rest. What is missing or frozen is a [`fault`](Self::fault).
///
/// Each tick takes q̇*, from an [`Ik`](crate::Ik) for example, and the measured state. q* is the integral of q̇*
/// within the leash of q. When the leash is reached q* is q until the caller, who is told so, has brought
/// q̇* to rest. Joints that are not driven by torque, such as those of a base that takes velocities,
/// are desired where they are measured. Torque limits are the model's efforts. After construction nothing
/// allocates, unless an error is returned.
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
    /// Of each joint that is driven by torque: its entries of q and of q̇.
    joints: Vec<(usize, usize)>,
    impedance: JointImpedance,
    support: SupportTorque,
    watch: MeasurementWatch,
    /// Of the joints that are driven by torque.
    prediction: StatePrediction,
    /// Whether the state was not known well enough in the last tick.
    is_lost: bool,
    resynchronisation: Resynchronisation,
    following: Following,
    /// q*.
    desired: Vec<f64>,
    /// The whole robot as it is predicted.
    position: Vec<f64>,
    velocity: Vec<f64>,
    acceleration: Vec<f64>,
    /// q̇* of the tick before.
    commanded: Vec<f64>,
    room: Gathered,
}

/// What the law sees, one element a joint that is driven by torque.
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
    /// A robot at rest at the `measured` configuration.
    ///
    /// # Errors
    /// [`Error::UnknownName`], [`Error::Unsuitable`] for a joint that torque cannot drive;
    /// [`Error::UnknownEffort`]; those of [`JointImpedance::new`]; [`Error::Value`] for a leash out of range; those of
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
            is_lost: false,
            position: measured.to_vec(),
            velocity: all.clone(),
            acceleration: all.clone(),
            commanded: all,
            resynchronisation: Resynchronisation::of_model(model, &settings.leash)?,
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

    /// The torques for the next `period` \[s\], one a joint that is driven by torque \[Nm or N\], with
    /// q̇* = `velocity` and the state, q and q̇ of the whole robot, as measured `age` \[s\] ago: the time since the
    /// measurement came and what is known of its delay beyond one period.
    ///
    /// # Errors
    /// [`Error::WrongSize`], [`Error::Value`], [`Error::Value`], [`Error::Value`] for the
    /// period. No torque then leaves, and the desired state is as before.
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
        let lost = self.watch.fault().is_some();
        // Nothing is made up for when the robot is measured again.
        if lost || self.is_lost {
            self.resynchronisation.restart();
        }
        self.is_lost = lost;
        self.following = self.resynchronisation.hold(&mut self.desired, &self.position, rests)?;
        self.advance(velocity, period);
        self.support(velocity)?;
        self.gather(velocity);
        self.commanded.copy_from_slice(velocity);
        let room = &self.room;
        let desired = JointState { position: &room.desired, velocity: &room.desired_velocity };
        let state = JointState { position: &room.measured, velocity: &room.measured_velocity };
        self.impedance.torque(desired, state, &room.support, period)
    }

    /// Where the robot is by now, by what was measured.
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

    /// q* goes on along q̇*, where torque drives it.
    fn advance(&mut self, velocity: &[f64], period: f64) {
        let mut driven = self.joints.iter().peekable();
        for (index, (desired, now)) in self.desired.iter_mut().zip(&self.position).enumerate() {
            match driven.next_if(|(position, _)| *position == index) {
                Some((_, entry)) => *desired += velocity[*entry] * period,
                None => *desired = *now,
            }
        }
    }

    /// What the robot needs beside springs and dampers.
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

    /// What is wrong with the measurements: bring q̇* to rest, and end the loop unless they come again.
    pub fn fault(&self) -> Option<MeasurementFault> {
        self.watch.fault()
    }

    /// Whether the robot followed in the last tick; where it does not, bring q̇* to rest.
    pub fn following(&self) -> Following {
        self.following
    }

    /// q*, a whole q: where tasks are to be computed.
    pub fn desired(&self) -> &[f64] {
        &self.desired
    }

    /// q* starts anew from q, as at the end of the leash: the robot gives way until q̇* has come to rest.
    pub fn give_way(&mut self) {
        self.resynchronisation.resynchronise();
        self.following = Following::Resynchronising;
    }
}

/// The entries of q and q̇ of joints by name, in the order of q.
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
