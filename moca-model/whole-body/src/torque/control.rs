//! Torque control of a robot that follows velocities.

use super::impedance::JointState;
use super::law::{TorqueLaw, TorqueSettings};
use super::measurement_watch::MeasurementFault;
use super::resynchronisation::{Following, FollowingErrorSettings, Resynchronisation};
use crate::error::{Error, check_finite};
use crate::robot::model::Model;

/// Turns velocities into torques by a [`TorqueLaw`]. The desired state stays near the measured one even if the robot is
/// held ([`Resynchronisation`]).
///
/// Each tick takes q̇*, from an [`Ik`](crate::Ik) for example, and the measured state. q* is the integral of q̇* within
/// the following-error limit of q. When the following-error limit is reached, q* is set to q until the caller, who is
/// told so, has brought q̇* to rest. The desired position of other joints, such as those of a base that takes
/// velocities, is the predicted one. After construction nothing allocates, unless an error is returned.
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
    law: TorqueLaw,
    resynchronisation: Resynchronisation,
    following: Following,
    /// q*.
    desired: Vec<f64>,
    /// q̇* of the last tick.
    commanded: Vec<f64>,
}

impl TorqueControl {
    /// Creates a controller for a robot at rest at the `measured` configuration. Following errors have the limits of
    /// [`FollowingErrorSettings`].
    ///
    /// # Errors
    /// Those of [`TorqueLaw::new`].
    pub fn new(model: &Model, settings: TorqueSettings, measured: &[f64]) -> Result<Self, Error> {
        let law = TorqueLaw::new(model, settings, measured)?;
        Ok(Self {
            law,
            resynchronisation: Resynchronisation::of_model(
                model,
                FollowingErrorSettings::default(),
            )?,
            following: Following::Follows,
            desired: measured.to_vec(),
            commanded: vec![0.0; model.velocity_count()],
        })
    }

    /// Sets the largest following errors of joints. Beyond them the desired state restarts from the measured one.
    ///
    /// # Errors
    /// Those of [`Resynchronisation::of_model`].
    pub fn limit_following_error(&mut self, limits: FollowingErrorSettings) -> Result<(), Error> {
        self.resynchronisation = Resynchronisation::of_model(self.law.model(), limits)?;
        Ok(())
    }

    /// Computes the torques for the next `period` \[s\], one for each joint with a torque drive \[Nm or N\].
    ///
    /// q̇* is `velocity`. The state, q and q̇ of the whole robot, was measured `age` \[s\] ago. The age is the time
    /// since the measurement came plus the known part of its delay beyond one period.
    ///
    /// # Errors
    /// [`Error::Size`]; [`Error::Value`] for states and the period. No torque is then sent, and the desired state
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
        self.law.model().check_velocity("q̇*", velocity)?;
        self.law.observe(measured, &self.commanded, age, period, period)?;
        let rests = velocity.iter().all(|velocity| *velocity == 0.0);
        // The desired state restarts from the measured one, so that no error of the time without measurements is
        // corrected.
        let restarts = self.law.is_recovering() && self.resynchronisation.restart();
        let present = self.law.state().position;
        self.following = self.resynchronisation.clamp(&mut self.desired, present, rests)?;
        // A short gap is no reason to come to rest.
        if restarts && self.law.fault().is_none() {
            self.following = Following::Follows;
        }
        self.advance(velocity, period);
        self.commanded.copy_from_slice(velocity);
        let weight = self.law.weight();
        self.law.step(JointState { position: &self.desired, velocity }, [weight; 2], period)
    }

    /// Advances q* by q̇* for joints with torque drives.
    fn advance(&mut self, velocity: &[f64], period: f64) {
        let mut driven = self.law.joints().iter().peekable();
        let joints = self.desired.iter_mut().zip(self.law.state().position);
        for (index, (desired, now)) in joints.enumerate() {
            match driven.next_if(|(position, _)| *position == index) {
                Some((_, entry)) => *desired += velocity[*entry] * period,
                None => *desired = *now,
            }
        }
    }

    /// The fault of the measurements. Bring q̇* to rest then, and end the loop unless they recover.
    pub fn fault(&self) -> Option<MeasurementFault> {
        self.law.fault()
    }

    /// Following of the robot in the last tick. If it does not follow, bring q̇* to rest.
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
