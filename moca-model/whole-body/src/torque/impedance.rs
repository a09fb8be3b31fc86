//! Joint impedance of a torque-controlled robot.

use crate::error::{Error, check_finite, check_size};
use crate::robot::limits::JointLimits;

/// Gains and rate limit of a [`JointImpedance`], one element a joint.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct ImpedanceSettings {
    /// `K_qp`, diagonal \[Nm/rad\]; default 600 600 600 600 250 150 50.
    pub stiffness: Vec<f64>,
    /// `K_qd`, diagonal \[Nm s/rad\]; default 50 50 50 20 20 20 10.
    pub damping: Vec<f64>,
    /// Largest change of a torque \[Nm/s\]; default 1000, that is 1 Nm a millisecond.
    pub torque_rate: f64,
}

impl Default for ImpedanceSettings {
    /// The Panda's gains in its manufacturer's joint impedance example.
    fn default() -> Self {
        Self {
            stiffness: vec![600.0, 600.0, 600.0, 600.0, 250.0, 150.0, 50.0],
            damping: vec![50.0, 50.0, 50.0, 20.0, 20.0, 20.0, 10.0],
            torque_rate: 1000.0,
        }
    }
}

impl ImpedanceSettings {
    /// Creates gains with which a Panda yields easily: stiffness 24 24 24 24 10 6 2, damping 2 2 2 1 1 1 0.5.
    pub fn soft() -> Self {
        Self {
            stiffness: vec![24.0, 24.0, 24.0, 24.0, 10.0, 6.0, 2.0],
            damping: vec![2.0, 2.0, 2.0, 1.0, 1.0, 1.0, 0.5],
            ..Self::default()
        }
    }

    /// Checks the settings for `joints` joints.
    ///
    /// # Errors
    /// [`Error::Size`]; [`Error::Value`] for a gain that is not a positive number;
    /// [`Error::Value`] for the rate.
    pub fn validate(&self, joints: usize) -> Result<(), Error> {
        for (name, gains) in [("stiffness", &self.stiffness), ("damping", &self.damping)] {
            check_size(name, gains.len(), joints)?;
            let bad =
                gains.iter().enumerate().find(|(_, gain)| !(**gain > 0.0 && gain.is_finite()));
            if let Some((index, &value)) = bad {
                return Err(Error::value(
                    format!("the {name} of joint {}", index + 1),
                    value,
                    "positive and finite",
                ));
            }
        }
        check_positive(self.torque_rate, "the torque rate [Nm/s]")
    }
}

/// Positions and velocities of joints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointState<'a> {
    /// \[rad\]
    pub position: &'a [f64],
    /// \[rad/s\]
    pub velocity: &'a [f64],
}

/// The way in which the changes of torques are limited.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum RateLimit {
    /// Limit of each torque's change by the torque rate.
    #[default]
    Each,
    /// Scaling of all changes by the same factor. Torques of coupled joints that balance each other then do so while
    /// they fade.
    Together,
}

/// Torques that make joints follow their desired motion like springs and dampers.
///
/// τ = `K_qd` (q̇* − q̇) + `K_qp` (q* − q) + g(q) is joint impedance control with gravity compensation (Siciliano,
/// Sciavicco, Villani, Oriolo, *Robotics*, 2009, Sec. 8.5.1). The change of each torque in a tick is limited
/// ([`RateLimit`]), then its size. Torques are only returned if all are finite and within the limits.
/// [`TorqueControl`](crate::torque::TorqueControl) also keeps q* near q.
///
/// ```
/// use whole_body::robot::JointLimits;
/// use whole_body::torque::{ImpedanceSettings, JointImpedance, JointState};
///
/// let limits = [JointLimits { effort: 12.0, ..JointLimits::UNLIMITED }; 2];
/// let settings = ImpedanceSettings {
///     stiffness: vec![600.0, 250.0],
///     damping: vec![50.0, 20.0],
///     torque_rate: 1000.0,
/// };
/// let mut impedance = JointImpedance::new(settings, &limits)?;
///
/// // Each millisecond, with g(q) at the position measured:
/// let measured = JointState { position: &[0.3, 0.2], velocity: &[0.0, 0.0] };
/// let desired = JointState { position: &[0.301, 0.2], velocity: &[0.0, 0.0] };
/// let torque = impedance.torque(desired, measured, &[4.0, 1.0], 0.001)?;
/// assert!((torque[0] - 4.6).abs() < 1e-12); // 4 Nm + 600 Nm/rad · 0.001 rad
/// # Ok::<(), whole_body::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct JointImpedance {
    settings: ImpedanceSettings,
    /// Largest torques \[Nm\].
    effort: Vec<f64>,
    /// Last returned torques \[Nm\]; without meaning before the first.
    sent: Vec<f64>,
    has_sent: bool,
    rate_limit: RateLimit,
    /// Torques being computed \[Nm\].
    torque: Vec<f64>,
}

impl JointImpedance {
    /// Creates a controller for the joints of `limits`, of which only the effort is used.
    ///
    /// # Errors
    /// Those of [`ImpedanceSettings::validate`], and [`Error::Value`] for an
    /// effort limit.
    pub fn new(settings: ImpedanceSettings, limits: &[JointLimits]) -> Result<Self, Error> {
        let joints = limits.len();
        settings.validate(joints)?;
        for limit in limits {
            check_positive(limit.effort, "the effort limit [Nm] of a joint that torque drives")?;
        }
        Ok(Self {
            settings,
            effort: limits.iter().map(|limit| limit.effort).collect(),
            sent: vec![0.0; joints],
            has_sent: false,
            rate_limit: RateLimit::Each,
            torque: vec![0.0; joints],
        })
    }

    /// Computes the torques for one tick of `dt` \[s\], one a joint \[Nm\].
    ///
    /// `gravity` is g(q) at the measured position \[Nm\]. The change of the first torque counts from `gravity`, as if
    /// the robot had been held still.
    ///
    /// # Errors
    /// [`Error::Size`]; [`Error::Value`] for states and dt. No torque is then returned, and the rate limit
    /// continues from the last one.
    pub fn torque(
        &mut self,
        desired: JointState<'_>,
        measured: JointState<'_>,
        gravity: &[f64],
        dt: f64,
    ) -> Result<&[f64], Error> {
        self.check(&desired, &measured, gravity, dt)?;
        self.spring_and_damper(&desired, &measured, gravity);
        self.limit(gravity, self.settings.torque_rate * dt);
        for (joint, &torque) in self.torque.iter().enumerate() {
            check_finite(torque, || format!("the torque of joint {}", joint + 1))?;
        }
        self.sent.copy_from_slice(&self.torque);
        self.has_sent = true;
        Ok(&self.sent)
    }

    /// Sets how the changes of torques are limited from now on; [`RateLimit::Each`] at first.
    pub fn limit_rate(&mut self, rate_limit: RateLimit) {
        self.rate_limit = rate_limit;
    }

    /// Forgets the last torque, so that the change of the next one counts from gravity.
    pub fn reset(&mut self) {
        self.has_sent = false;
    }

    fn check(
        &self,
        desired: &JointState<'_>,
        measured: &JointState<'_>,
        gravity: &[f64],
        dt: f64,
    ) -> Result<(), Error> {
        let inputs = [
            ("the desired position", desired.position),
            ("the desired velocity", desired.velocity),
            ("the measured position", measured.position),
            ("the measured velocity", measured.velocity),
            ("the gravity torque", gravity),
        ];
        for (name, values) in inputs {
            check_size(name, values.len(), self.torque.len())?;
            for (joint, &value) in values.iter().enumerate() {
                check_finite(value, || format!("{name}, joint {},", joint + 1))?;
            }
        }
        check_finite(dt, || "the time step [s]".to_owned())?;
        check_positive(dt, "the time step [s]")
    }

    /// τ = `K_qd` (q̇* − q̇) + `K_qp` (q* − q) + g(q).
    fn spring_and_damper(
        &mut self,
        desired: &JointState<'_>,
        measured: &JointState<'_>,
        gravity: &[f64],
    ) {
        let gains = self.settings.stiffness.iter().zip(&self.settings.damping);
        let positions = desired.position.iter().zip(measured.position);
        let velocities = desired.velocity.iter().zip(measured.velocity);
        let joints = gains.zip(positions.zip(velocities)).zip(gravity);
        for (torque, (((stiffness, damping), (position, velocity)), gravity)) in
            self.torque.iter_mut().zip(joints)
        {
            *torque = damping * (velocity.0 - velocity.1)
                + stiffness * (position.0 - position.1)
                + gravity;
        }
    }

    /// Limits the change since the last torque to `step` \[Nm\], then the size. The last torque is within the effort,
    /// so that both limits hold.
    fn limit(&mut self, gravity: &[f64], step: f64) {
        let last = if self.has_sent { &self.sent } else { gravity };
        if self.rate_limit == RateLimit::Together {
            let changes = self.torque.iter().zip(last).map(|(torque, last)| (torque - last).abs());
            let largest = changes.fold(0.0, f64::max);
            let share = if largest > step { step / largest } else { 1.0 };
            for (torque, last) in self.torque.iter_mut().zip(last) {
                *torque = last + share * (*torque - last);
            }
        }
        for ((torque, last), effort) in self.torque.iter_mut().zip(last).zip(&self.effort) {
            let last = clamp(*last, *effort);
            *torque = clamp(last + clamp(*torque - last, step), *effort);
        }
    }
}

/// Returns an error unless `value` is positive; infinity counts as positive.
fn check_positive(value: f64, what: &'static str) -> Result<(), Error> {
    if value > 0.0 { Ok(()) } else { Err(Error::not_positive(what, value)) }
}

/// Limits `value` to ±`bound`. NaN is kept for the later check.
fn clamp(value: f64, bound: f64) -> f64 {
    if value > bound {
        bound
    } else if value < -bound {
        -bound
    } else {
        value
    }
}
