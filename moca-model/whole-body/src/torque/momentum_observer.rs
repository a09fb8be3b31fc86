//! Estimation of external torques from a robot's motion and its motors' torques.

use super::joints::joints;
use crate::error::{Error, check_size};
use crate::robot::model::Model;
use crate::state::moving::Moving;

/// The treatment of joint friction by an observer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum ObservedFriction {
    /// Friction counts as an external torque. This suits torques that are measured at the output of the gears.
    #[default]
    External,
    /// The friction of the [`Description`](crate::Description) is subtracted.
    Modelled,
}

/// Settings of a [`MomentumObserver`].
#[derive(Debug, Clone, PartialEq)]
pub struct ObserverSettings {
    /// The observed joints, in the order of q; an empty list means all. Default empty.
    pub joints: Vec<String>,
    /// `K_O` of each of them \[1/s\]. The estimate follows the external torque as a first-order lag of time constant
    /// `1/K_O`. Default 50 1/s for seven joints.
    pub rates: Vec<f64>,
    /// Treatment of joint friction. Default external.
    pub friction: ObservedFriction,
}

impl Default for ObserverSettings {
    fn default() -> Self {
        Self { joints: Vec::new(), rates: vec![50.0; 7], friction: ObservedFriction::default() }
    }
}

/// The generalised-momentum observer. It estimates the external torque on each joint without acceleration sensors and
/// without inverting the mass matrix.
///
/// r = `K_O` (p(t) − p(0) − ∫ (τ + C(q, q̇)ᵀ q̇ − g(q) + r) ds), p = M(q) q̇, so that
/// ṙ = `K_O` (τ_ext − r). (De Luca, Albu-Schäffer, Haddadin, Hirzinger, "Collision detection and safe
/// reaction with the DLR-III lightweight robot arm", IROS 2006; De Luca, Mattone, "Sensorless robot
/// collision detection and hybrid force/motion control", ICRA 2005.)
///
/// In discrete time, the integral of τ is that of the torque applied since the last update. The trapezoidal rule
/// integrates Cᵀ q̇ − g. The integral of r is implicit, so that the observer is stable for every rate: r ← (r + `K_O`
/// (Δp − Δt u)) / (1 + `K_O` Δt). After construction nothing allocates.
///
/// ```
/// use whole_body::torque::{MomentumObserver, ObserverSettings};
/// use whole_body::Data;
/// # use whole_body::{Description, Model};
/// # let model = Model::from_urdf(r#"<robot name="one"><link name="base"/>
/// #   <link name="tip"><inertial><origin xyz="0 0 0.2"/><mass value="2"/>
/// #   <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
/// #   <joint name="hinge" type="revolute"><parent link="base"/><child link="tip"/><axis xyz="0 0 1"/>
/// #   <limit lower="-1" upper="1" velocity="1" effort="50"/></joint></robot>"#, &Description::default())?;
/// let settings = ObserverSettings { rates: vec![50.0], ..ObserverSettings::default() };
/// let mut observer = MomentumObserver::new(&model, settings)?;
/// let mut data = Data::new(&model);
/// for _ in 0..500 {
///     // Each millisecond. The motor gives 3 Nm, and the robot stands still: somebody holds it.
///     let mut moving = data.pose(&model, &[0.1])?.moving(&[0.0])?;
///     observer.update(&mut moving, &[3.0], 1e-3)?;
/// }
/// assert!((observer.torque()[0] + 3.0).abs() < 1e-6);
/// # Ok::<(), whole_body::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct MomentumObserver {
    /// Entry of q̇ and rate of each joint.
    joints: Vec<(usize, f64)>,
    friction: ObservedFriction,
    /// True if there has been an update.
    began: bool,
    /// Momentum of the whole robot, now and at the last update.
    momentum: [Vec<f64>; 2],
    /// Cᵀ q̇ − g − friction, now and at the last update.
    bias: [Vec<f64>; 2],
    friction_torque: Vec<f64>,
    /// r, the estimate.
    torque: Vec<f64>,
}

impl MomentumObserver {
    /// Creates an observer for a robot.
    ///
    /// # Errors
    /// [`Error::UnknownName`]; [`Error::Unsuitable`]; [`Error::Size`] unless there is a rate for each joint;
    /// [`Error::Value`] for a rate that is not positive.
    pub fn new(model: &Model, settings: ObserverSettings) -> Result<Self, Error> {
        let entries = joints(model, &settings.joints)?;
        check_size("the list of rates", settings.rates.len(), entries.len())?;
        let bad = |rate: &f64| !(*rate > 0.0 && rate.is_finite());
        if let Some((index, &value)) = settings.rates.iter().enumerate().find(|(_, rate)| bad(rate))
        {
            return Err(Error::value(
                format!("the rate of joint {}", index + 1),
                value,
                "positive and finite",
            ));
        }
        let none = vec![0.0; model.velocity_count()];
        Ok(Self {
            torque: vec![0.0; entries.len()],
            joints: entries.into_iter().map(|(_, entry)| entry).zip(settings.rates).collect(),
            friction: settings.friction,
            began: false,
            momentum: [none.clone(), none.clone()],
            bias: [none.clone(), none.clone()],
            friction_torque: none,
        })
    }

    /// Updates the estimate and returns it \[Nm or N\]. `robot` is the robot as measured now. `torque` is the mean
    /// torque on each observed joint since the last update, `period` \[s\] ago. The estimate begins at zero.
    ///
    /// # Errors
    /// [`Error::Size`]; [`Error::Value`] for torque and period. The estimate is then unchanged.
    pub fn update(
        &mut self,
        robot: &mut Moving<'_>,
        torque: &[f64],
        period: f64,
    ) -> Result<&[f64], Error> {
        check_size("the list of torques", torque.len(), self.joints.len())?;
        for (index, &value) in torque.iter().enumerate() {
            let what = || format!("the torque of joint {}", index + 1);
            crate::error::check_finite(value, what)?;
        }
        if !(period > 0.0 && period.is_finite()) {
            return Err(Error::not_positive("the time step [s]", period));
        }
        check_size("the robot's q̇", robot.velocity().len(), self.friction_torque.len())?;
        self.remember(robot)?;
        if self.began {
            self.advance(torque, period);
        }
        self.began = true;
        Ok(&self.torque)
    }

    /// Computes momentum and bias of the robot, and keeps those of the last update.
    fn remember(&mut self, robot: &mut Moving<'_>) -> Result<(), Error> {
        self.momentum.swap(0, 1);
        self.bias.swap(0, 1);
        let ([momentum, _], [bias, _]) = (&mut self.momentum, &mut self.bias);
        robot.joint_momentum_into(momentum, bias)?;
        if self.friction == ObservedFriction::Modelled {
            robot.friction_into(&mut self.friction_torque)?;
            let friction = bias.iter_mut().zip(&self.friction_torque);
            friction.for_each(|(bias, friction)| *bias -= friction);
        }
        Ok(())
    }

    fn advance(&mut self, torque: &[f64], period: f64) {
        let ([momentum, last_momentum], [bias, last_bias]) = (&self.momentum, &self.bias);
        let joints = self.joints.iter().zip(torque);
        for (estimate, ((entry, rate), torque)) in self.torque.iter_mut().zip(joints) {
            let known = torque + 0.5 * (bias[*entry] + last_bias[*entry]);
            let missing = momentum[*entry] - last_momentum[*entry] - period * known;
            *estimate = (*estimate + rate * missing) / (1.0 + rate * period);
        }
    }

    /// The estimated external torque on each observed joint \[Nm or N\].
    pub fn torque(&self) -> &[f64] {
        &self.torque
    }

    /// Restarts the observer with an estimate of zero.
    pub fn reset(&mut self) {
        self.began = false;
        self.torque.fill(0.0);
    }
}
