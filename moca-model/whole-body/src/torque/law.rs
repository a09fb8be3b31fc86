//! The torque law: springs and dampers on a predicted state, and the torques that support the robot.

use super::impedance::{ImpedanceSettings, JointImpedance, JointState};
use super::joints::joints;
use super::measurement_watch::{MeasurementFault, MeasurementWatch};
use super::prediction::StatePrediction;
use super::support::{Compensation, SupportTorque, SupportedMotion};
use crate::error::{Error, check_size};
use crate::robot::joint::JointKind;
use crate::robot::model::Model;
use crate::state::data::Data;

/// Settings of a [`TorqueLaw`]. They have no default, because the compensation of the robot itself must be stated.
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
}

impl TorqueSettings {
    /// Creates settings with a Panda's gains for all joints and an interface with this compensation.
    pub fn new(compensation: Compensation) -> Self {
        Self {
            joints: Vec::new(),
            compensation,
            rotor_inertia: 0.1,
            impedance: ImpedanceSettings::default(),
        }
    }
}

/// Torques that make joints follow a desired state: [`JointImpedance`] on the predicted state of the robot, and
/// [`SupportTorque`]. [`TorqueControl`](crate::torque::TorqueControl) also makes the desired state from velocities.
///
/// Each tick takes a measurement by [`observe`](Self::observe), then the desired state by [`step`](Self::step). Between
/// measurements the state is predicted ([`StatePrediction`]), for joints with and without torque drives. Springs and
/// dampers fade with the age of the measurement, until the robot only supports itself. Missing or frozen measurements
/// ([`MeasurementWatch`]) are a [`fault`](Self::fault). Torque limits are the model's efforts. After construction
/// nothing allocates, unless an error is returned.
///
/// ```
/// use whole_body::torque::{Compensation, ImpedanceSettings, JointState, TorqueLaw, TorqueSettings};
/// # use whole_body::{Description, Model};
/// # let model = Model::from_urdf(r#"<robot name="one"><link name="base"/>
/// #   <link name="tip"><inertial><origin xyz="0 0 0.2"/><mass value="2"/>
/// #   <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
/// #   <joint name="hinge" type="revolute"><parent link="base"/><child link="tip"/><axis xyz="0 1 0"/>
/// #   <limit lower="-1" upper="1" velocity="1" effort="50"/></joint></robot>"#, &Description::default())?;
/// let settings = TorqueSettings {
///     impedance: ImpedanceSettings { stiffness: vec![400.0], damping: vec![20.0], torque_rate: 1000.0 },
///     ..TorqueSettings::new(Compensation::FRANKA) // the robot adds gravity
/// };
/// let rest = JointState { position: &[0.1], velocity: &[0.0] };
/// let mut law = TorqueLaw::new(&model, settings, rest.position)?;
/// // Each millisecond:
/// law.observe(rest, &[0.0], 0.0, 1e-3, 1e-3)?;
/// let desired = JointState { position: &[0.101], velocity: &[0.0] };
/// let torque = law.step(desired, [law.weight(); 2], 1e-3)?;
/// assert!((torque[0] - 0.4).abs() < 1e-9); // 400 Nm/rad · 0.001 rad
/// # Ok::<(), whole_body::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct TorqueLaw {
    model: Model,
    data: Data,
    /// Entries of q and q̇ of the joints whose state is predicted: all but floating ones.
    predicted: Vec<(usize, usize)>,
    /// Entries of q and q̇ of the joints with torque drives.
    driven: Vec<(usize, usize)>,
    impedance: JointImpedance,
    support: SupportTorque,
    watch: MeasurementWatch,
    prediction: StatePrediction,
    /// Delay of measurements and commands \[s\].
    delay: f64,
    /// Predicted state of the whole robot.
    position: Vec<f64>,
    velocity: Vec<f64>,
    acceleration: Vec<f64>,
    measured: Sample,
    springs: Springs,
    /// A joint with a torque drive, and the torque that it gets in addition in the next step \[Nm or N\].
    push: Option<(usize, f64)>,
    torque: Vec<f64>,
}

/// A measurement, one element for each joint whose state is predicted.
#[derive(Debug, Clone)]
struct Sample {
    position: Vec<f64>,
    velocity: Vec<f64>,
    commanded: Vec<f64>,
}

/// Inputs of the impedance law, one element for each joint with a torque drive.
#[derive(Debug, Clone)]
struct Springs {
    desired: Vec<f64>,
    desired_velocity: Vec<f64>,
    position: Vec<f64>,
    velocity: Vec<f64>,
    support: Vec<f64>,
}

impl TorqueLaw {
    /// Creates the law for a robot at rest at the `measured` configuration \[rad or m\]. Its first torques support
    /// the robot.
    ///
    /// # Errors
    /// [`Error::UnknownName`], [`Error::Unsuitable`] for a joint that torque cannot drive; [`Error::UnknownEffort`];
    /// those of [`JointImpedance::new`] and [`SupportTorque::new`]; those of [`Data::pose`] on the configuration.
    pub fn new(model: &Model, settings: TorqueSettings, measured: &[f64]) -> Result<Self, Error> {
        model.check_configuration(measured)?;
        let driven = joints(model, &settings.joints)?;
        driven.iter().try_for_each(|(_, entry)| model.expect_effort(*entry))?;
        let limits: Vec<_> = driven.iter().map(|(_, entry)| model.limits()[*entry]).collect();
        let predicted: Vec<_> = model
            .joints()
            .iter()
            .filter(|joint| joint.kind != JointKind::Floating)
            .map(|joint| (joint.position_index, joint.velocity_index))
            .collect();
        let position: Vec<_> = predicted.iter().map(|(position, _)| measured[*position]).collect();
        let is_driven = |joint: &usize| driven.contains(&predicted[*joint]);
        let drives: Vec<_> = (0..predicted.len()).filter(is_driven).collect();
        let [none, some, all] =
            [driven.len(), predicted.len(), model.velocity_count()].map(|size| vec![0.0; size]);
        let mut law = Self {
            data: Data::new(model),
            impedance: JointImpedance::new(settings.impedance, &limits)?,
            support: SupportTorque::new(model, settings.compensation, settings.rotor_inertia)?,
            watch: MeasurementWatch::new(predicted.len()),
            prediction: StatePrediction::new(&position, &drives),
            delay: 0.0,
            position: measured.to_vec(),
            velocity: all.clone(),
            acceleration: all.clone(),
            measured: Sample { position, velocity: some.clone(), commanded: some },
            springs: Springs {
                desired: none.clone(),
                desired_velocity: none.clone(),
                position: none.clone(),
                velocity: none.clone(),
                support: none.clone(),
            },
            push: None,
            torque: none,
            model: model.clone(),
            predicted,
            driven,
        };
        law.support(&all)?;
        law.torque.copy_from_slice(&law.springs.support);
        Ok(law)
    }

    /// Takes the state of the whole robot, which was measured `age` \[s\] ago, and predicts the present one.
    ///
    /// The age is the time since the measurement came. `commanded` is q̇* of the period that ends now, `elapsed` the time
    /// since the last tick \[s\], and `period` the period of the commands \[s\].
    ///
    /// # Errors
    /// [`Error::Size`], [`Error::Value`]; nothing is then changed.
    pub fn observe(
        &mut self,
        measured: JointState<'_>,
        commanded: &[f64],
        age: f64,
        elapsed: f64,
        period: f64,
    ) -> Result<(), Error> {
        self.model.check_configuration(measured.position)?;
        self.model.check_velocity("q̇", measured.velocity)?;
        self.model.check_velocity("q̇*", commanded)?;
        let Self { measured: sample, predicted, watch, prediction, delay, .. } = self;
        for (joint, (position, entry)) in predicted.iter().enumerate() {
            sample.position[joint] = measured.position[*position];
            sample.velocity[joint] = measured.velocity[*entry];
            sample.commanded[joint] = commanded[*entry];
        }
        let state = JointState { position: &sample.position, velocity: &sample.velocity };
        let age = watch.update(state, &sample.commanded, age, elapsed);
        let (age, awaited) = (*delay + age, *delay + watch.awaited());
        prediction.update(state, &sample.commanded, age, awaited, period)?;
        self.position.copy_from_slice(measured.position);
        self.velocity.copy_from_slice(measured.velocity);
        for (joint, (position, entry)) in predicted.iter().enumerate() {
            self.position[*position] = prediction.position()[joint];
            self.velocity[*entry] = prediction.velocity()[joint];
            self.acceleration[*entry] = prediction.modelled_acceleration()[joint];
        }
        Ok(())
    }

    /// Computes the torques for the next `period` \[s\], one for each joint with a torque drive \[Nm or N\].
    ///
    /// The `desired` state is that of the whole robot. Springs and dampers act on these shares, 0 to 1, of its
    /// difference from the predicted state; usually both are [`weight`](Self::weight).
    ///
    /// # Errors
    /// [`Error::Size`]; [`Error::Value`] for states and the period. The torques are then unchanged.
    pub fn step(
        &mut self,
        desired: JointState<'_>,
        [spring, damper]: [f64; 2],
        period: f64,
    ) -> Result<&[f64], Error> {
        check_size("q*", desired.position.len(), self.position.len())?;
        self.support(desired.velocity)?;
        if let Some((joint, torque)) = self.push.take()
            && let Some(support) = self.springs.support.get_mut(joint)
        {
            *support += torque;
        }
        let springs = &mut self.springs;
        for (joint, (position, entry)) in self.driven.iter().enumerate() {
            let (now, moving) = (self.position[*position], self.velocity[*entry]);
            springs.position[joint] = now;
            springs.velocity[joint] = moving;
            springs.desired[joint] = now + spring * (desired.position[*position] - now);
            springs.desired_velocity[joint] = moving + damper * (desired.velocity[*entry] - moving);
        }
        let desired =
            JointState { position: &springs.desired, velocity: &springs.desired_velocity };
        let state = JointState { position: &springs.position, velocity: &springs.velocity };
        self.impedance.limit_rate(self.prediction.rate_limit());
        let torque = self.impedance.torque(desired, state, &springs.support, period)?;
        self.torque.copy_from_slice(torque);
        Ok(&self.torque)
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
        let torque = self.support.update(&mut self.data, &self.model, &motion)?;
        for (own, (_, entry)) in self.springs.support.iter_mut().zip(&self.driven) {
            *own = torque[*entry];
        }
        Ok(())
    }

    /// Adds a torque to one of the joints with torque drives in the next step \[Nm or N\].
    pub fn push(&mut self, joint: usize, torque: f64) {
        self.push = Some((joint, torque));
    }

    /// Sets the delay of measurements beyond their age \[s\]. It is the time from a command to its effect in a
    /// measurement, minus the one period of every loop. Default 0.
    pub fn set_delay(&mut self, delay: f64) {
        self.delay = delay.max(0.0);
    }

    /// The assumed delay of measurements beyond their age \[s\].
    pub fn delay(&self) -> f64 {
        self.delay
    }

    /// Sets whether the robot does not take commands. Springs and dampers have no weight meanwhile.
    pub fn set_unheard(&mut self, is_unheard: bool) {
        self.prediction.set_unheard(is_unheard);
    }

    /// The predicted state of the whole robot. Floating joints are as measured.
    pub fn state(&self) -> JointState<'_> {
        JointState { position: &self.position, velocity: &self.velocity }
    }

    /// The weight of the measurement, 0 to 1.
    pub fn weight(&self) -> f64 {
        self.prediction.weight()
    }

    /// True if confidence is below 1; see [`StatePrediction::is_recovering`].
    pub fn is_recovering(&self) -> bool {
        self.prediction.is_recovering()
    }

    /// The true age of the measured state \[s\].
    pub fn age(&self) -> f64 {
        self.watch.age()
    }

    /// The fault of the measurements. Bring q̇* to rest then, and end the loop unless they recover.
    pub fn fault(&self) -> Option<MeasurementFault> {
        self.watch.fault()
    }

    /// Entries of q and q̇ of the joints with torque drives.
    pub fn joints(&self) -> &[(usize, usize)] {
        &self.driven
    }

    /// The torques of the last step \[Nm or N\].
    pub fn torque(&self) -> &[f64] {
        &self.torque
    }

    /// The robot.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The dynamics of the law, to attach payloads that the robot carries.
    pub fn data_mut(&mut self) -> &mut Data {
        &mut self.data
    }
}
