//! The safety state of the robot: what brought it there, and by which rule it recovers.

use crate::approach::Nearest;
use crate::error::{Error, not_negative, positive};
use crate::motion::is_period;

/// How much the robot may do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum SafetyState {
    /// Full speed.
    #[default]
    Normal,
    /// Reduced speed.
    Reduced,
    /// At rest, still under control.
    ProtectiveStop,
}

/// Something that went wrong in the control loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Fault {
    /// The solver found no command.
    NoSolution,
    /// A measurement or a command was not finite, or out of range.
    BadData,
    /// A limit of the robot was violated.
    LimitViolated,
    /// A control period was missed.
    LatePeriod,
}

/// What brought the robot to its state.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Cause {
    /// A person is near, but not too near.
    PersonNear(Nearest),
    /// The protective distance is undercut.
    TooClose(Nearest),
    /// People were not seen for too long.
    Stale {
        /// The age of the last percept \[s\].
        age: f64,
    },
    /// The loop reported a fault.
    Fault(Fault),
}

/// When the states change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SupervisorSettings {
    /// Room above the protective distance below which speed is reduced \[m\]. Default 0.5.
    pub reduced_room: f64,
    /// By how much the protective distance may be undercut before the robot stops, for noise
    /// \[m\]. Default 0.02.
    pub tolerance: f64,
    /// Additional room needed to recover \[m\]. Default 0.1.
    pub hysteresis: f64,
    /// How long the reason must be gone to recover \[s\]. Default 0.5.
    pub dwell: f64,
    /// Age of the last percept from which speed is reduced \[s\]. Default 0.3.
    pub reduced_age: f64,
    /// Age of the last percept from which the robot stops \[s\]. Default 0.8.
    pub stop_age: f64,
    /// Whether somebody must acknowledge a protective stop before the robot recovers; one for a
    /// fault must always be. Default false.
    pub acknowledge: bool,
    /// Share of the speed when reduced \[-\]. Default 0.3.
    pub reduced_scale: f64,
    /// Time from full speed to none, and back \[s\]. Default 0.5.
    pub ramp: f64,
}

impl Default for SupervisorSettings {
    fn default() -> Self {
        Self {
            reduced_room: 0.5,
            tolerance: 0.02,
            hysteresis: 0.1,
            dwell: 0.5,
            reduced_age: 0.3,
            stop_age: 0.8,
            acknowledge: false,
            reduced_scale: 0.3,
            ramp: 0.5,
        }
    }
}

impl SupervisorSettings {
    /// Checks the ranges.
    ///
    /// # Errors
    /// [`Error::Parameter`] names the first that is out of its range.
    pub fn validate(&self) -> Result<(), Error> {
        not_negative("supervisor.reduced_room", self.reduced_room)?;
        not_negative("supervisor.tolerance", self.tolerance)?;
        not_negative("supervisor.hysteresis", self.hysteresis)?;
        not_negative("supervisor.dwell", self.dwell)?;
        positive("supervisor.reduced_age", self.reduced_age)?;
        positive("supervisor.ramp", self.ramp)?;
        if self.stop_age.is_nan() || self.stop_age < self.reduced_age {
            let (name, expected) = ("supervisor.stop_age", "at least supervisor.reduced_age");
            return Err(Error::Parameter { name, value: self.stop_age, expected });
        }
        if !(0.0..=1.0).contains(&self.reduced_scale) {
            let (name, value) = ("supervisor.reduced_scale", self.reduced_scale);
            return Err(Error::Parameter { name, value, expected: "between 0 and 1" });
        }
        Ok(())
    }
}

/// What a tick tells the supervisor.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Observation {
    /// The pair with the least room, from [`ApproachRows::write`](crate::ApproachRows::write);
    /// none with nobody there.
    pub nearest: Option<Nearest>,
    /// The age of the last percept \[s\].
    pub age: f64,
    /// What went wrong.
    pub fault: Option<Fault>,
}

/// Goes down at once, comes up by rule.
///
/// ```
/// use hrsw::{Fault, Observation, SafetyState, Supervisor, SupervisorSettings};
///
/// let mut supervisor = Supervisor::new(SupervisorSettings::default())?;
/// let fault = Observation { fault: Some(Fault::BadData), ..Observation::default() };
/// supervisor.update(&fault, 1e-3);
/// assert_eq!(supervisor.state(), SafetyState::ProtectiveStop);
/// for _ in 0..2000 {
///     supervisor.update(&Observation::default(), 1e-3);
/// }
/// assert_eq!(supervisor.state(), SafetyState::ProtectiveStop); // a fault waits for somebody
/// supervisor.acknowledge();
/// supervisor.update(&Observation::default(), 1e-3);
/// assert_eq!(supervisor.state(), SafetyState::Reduced);
/// # Ok::<(), hrsw::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Supervisor {
    settings: SupervisorSettings,
    state: SafetyState,
    cause: Option<Cause>,
    clear_for: f64,
    waits: bool,
    scale: f64,
}

impl Supervisor {
    /// In the normal state, at full speed.
    ///
    /// # Errors
    /// [`Error::Parameter`] for settings out of range.
    pub fn new(settings: SupervisorSettings) -> Result<Self, Error> {
        settings.validate()?;
        let state = SafetyState::Normal;
        Ok(Self { settings, state, cause: None, clear_for: 0.0, waits: false, scale: 1.0 })
    }

    /// How much the robot may do.
    pub fn state(&self) -> SafetyState {
        self.state
    }

    /// What brought it to its state, as seen last; none in the normal state.
    pub fn cause(&self) -> Option<&Cause> {
        self.cause.as_ref()
    }

    /// The share of its speed that the robot may use, 0 to 1, ramped.
    pub fn speed_scale(&self) -> f64 {
        self.scale
    }

    /// Whether the present stop waits for [`acknowledge`](Self::acknowledge).
    pub fn waits_for_acknowledgement(&self) -> bool {
        self.waits
    }

    /// Somebody has seen to the reason of a stop. The robot still recovers only once the reason
    /// is gone.
    pub fn acknowledge(&mut self) {
        self.waits = false;
    }

    /// Takes what a tick observed, `period` \[s\] after the one before.
    ///
    /// A worse state is entered at once. A better one is entered, one step at a time, when what
    /// asks for the present one has been gone for the dwell time, with the hysteresis, and a
    /// stop that must be acknowledged has been.
    pub fn update(&mut self, observation: &Observation, period: f64) {
        // Without time nothing recovers; a worse state is still entered.
        let period = if is_period(period) { period } else { 0.0 };
        let (demanded, cause) = self.demand(observation, 0.0);
        if demanded >= self.state && demanded != SafetyState::Normal {
            self.enter(demanded, cause);
        } else if self.state != SafetyState::Normal {
            let (cautious, _) = self.demand(observation, self.settings.hysteresis);
            self.clear_for = if cautious < self.state { self.clear_for + period } else { 0.0 };
            if self.clear_for >= self.settings.dwell && !self.waits {
                self.recover(demanded, cause);
            }
        }
        let goal = match self.state {
            SafetyState::Normal => 1.0,
            SafetyState::Reduced => self.settings.reduced_scale,
            SafetyState::ProtectiveStop => 0.0,
        };
        let step = period / self.settings.ramp;
        self.scale += (goal - self.scale).clamp(-step, step);
    }

    fn enter(&mut self, state: SafetyState, cause: Option<Cause>) {
        let stops = state == SafetyState::ProtectiveStop;
        let fault = matches!(cause, Some(Cause::Fault(_)));
        let newly = self.state != state;
        self.waits |= stops && (fault || (newly && self.settings.acknowledge));
        self.state = state;
        self.cause = cause;
        self.clear_for = 0.0;
    }

    /// One step up. From a stop the reason of the stop stays the cause until normal.
    fn recover(&mut self, demanded: SafetyState, cause: Option<Cause>) {
        self.clear_for = 0.0;
        if self.state == SafetyState::ProtectiveStop {
            self.state = SafetyState::Reduced;
            self.cause = if demanded == SafetyState::Reduced { cause } else { self.cause };
        } else {
            self.state = SafetyState::Normal;
            self.cause = None;
        }
    }

    /// The state that the observation asks for, with `extra` room demanded.
    fn demand(&self, observation: &Observation, extra: f64) -> (SafetyState, Option<Cause>) {
        use SafetyState::{Normal, ProtectiveStop, Reduced};
        let settings = &self.settings;
        let Observation { nearest, age, fault } = *observation;
        if let Some(fault) = fault {
            return (ProtectiveStop, Some(Cause::Fault(fault)));
        }
        let room = nearest.map_or(f64::INFINITY, |pair| pair.room());
        if age.is_nan() || room.is_nan() {
            return (ProtectiveStop, Some(Cause::Fault(Fault::BadData)));
        }
        let closeness = nearest.filter(|_| room < extra - settings.tolerance);
        if let Some(pair) = closeness {
            return (ProtectiveStop, Some(Cause::TooClose(pair)));
        }
        if age > settings.stop_age {
            return (ProtectiveStop, Some(Cause::Stale { age }));
        }
        if let Some(pair) = nearest.filter(|_| room < settings.reduced_room + extra) {
            return (Reduced, Some(Cause::PersonNear(pair)));
        }
        if age > settings.reduced_age {
            return (Reduced, Some(Cause::Stale { age }));
        }
        (Normal, None)
    }
}
