//! Safety state machine: the state, its cause, and the rules of recovery.

use crate::age::Age;
use crate::approach::Nearest;
use crate::error::{Error, positive};
use crate::fault::Fault;

use crate::safety_state::SafetyState;

/// Cause of a safety state.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Cause {
    /// The protective distance is violated.
    TooClose(Nearest),
    /// The newest camera frame is too old.
    Stale {
        /// Age of the newest frame.
        age: Age,
    },
    /// The loop reported a fault.
    Fault(Fault),
}

impl Cause {
    /// Returns the priority among causes that ask for the same state. A fault comes before its
    /// consequences.
    fn rank(&self) -> u8 {
        match self {
            Self::Fault(_) => 2,
            Self::TooClose(_) => 1,
            Self::Stale { .. } => 0,
        }
    }

    /// Returns true if the robot is to stop as fast as it can instead of along a ramp. This holds
    /// for a fault that stops it, and while it moves towards a person who is too close.
    fn is_urgent(&self, state: SafetyState) -> bool {
        match self {
            Self::Fault(_) => state == SafetyState::ProtectiveStop,
            Self::TooClose(pair) => pair.approach > CREEP,
            Self::Stale { .. } => false,
        }
    }
}

/// A robot that is no faster than this towards a person does not approach \[m/s\].
const CREEP: f64 = 0.02;

/// Thresholds of the changes of state.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct SupervisorSettings {
    /// Age of the last percept above which speed is reduced \[s\]. Default 0.3.
    pub reduced_age: f64,
    /// Age of the last percept above which the robot stops \[s\]. Default 0.8.
    pub stop_age: f64,
    /// True if every protective stop must be acknowledged before the robot recovers. Some faults
    /// always require it, see [`Fault::waits`]. Default false.
    pub acknowledge: bool,
    /// Force from outside above which the robot stops and gives way \[N\], see
    /// [`Supervisor::set_external_force`]. Default 60, below the lowest limit of a region of the
    /// body in a quasi-static contact: 65 N on the face.
    pub contact_force: f64,
}

impl Default for SupervisorSettings {
    fn default() -> Self {
        Self { reduced_age: 0.3, stop_age: 0.8, acknowledge: false, contact_force: 60.0 }
    }
}

impl SupervisorSettings {
    /// Checks the ranges.
    ///
    /// # Errors
    /// [`Error::Value`] names the first setting that is out of its range.
    pub fn validate(&self) -> Result<(), Error> {
        positive("supervisor.reduced_age", self.reduced_age)?;
        positive("supervisor.contact_force", self.contact_force)?;
        if self.stop_age.is_nan() || self.stop_age < self.reduced_age {
            let (name, expected) = ("supervisor.stop_age", "at least supervisor.reduced_age");
            return Err(Error::Value { what: name, got: self.stop_age, wanted: expected });
        }
        Ok(())
    }
}

/// Observation of people in a tick. It has no default, since the absence of people must be
/// observed.
///
/// ```compile_fail
/// let nobody = hrsw_safety::Observation::default();
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observation {
    /// Pair with the least room, from [`ApproachRows::write`](crate::ApproachRows::write). None if
    /// nobody is there.
    pub nearest: Option<Nearest>,
    /// Age of the newest frame.
    pub age: Age,
}

/// Safety state machine. It enters a stricter state at once and recovers one state at a time.
///
/// ```
/// use hrsw_safety::{Age, Fault, Observation, SafetyState, Supervisor, SupervisorSettings};
///
/// let mut supervisor = Supervisor::new(SupervisorSettings::default())?;
/// let nobody = Observation { nearest: None, age: Age::new(0.05)? };
/// supervisor.report(Fault::BadMeasurement);
/// assert_eq!(supervisor.state(), SafetyState::ProtectiveStop);
/// for _ in 0..2000 {
///     supervisor.update(&nobody, 1e-3);
/// }
/// assert_eq!(supervisor.state(), SafetyState::ProtectiveStop); // it waits for somebody
/// assert_eq!(supervisor.unacknowledged(), Some(Fault::BadMeasurement));
/// supervisor.acknowledge();
/// supervisor.update(&nobody, 1e-3);
/// assert_eq!(supervisor.state(), SafetyState::Retreat); // one state at a time
/// # Ok::<(), hrsw_safety::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Supervisor {
    settings: SupervisorSettings,
    state: SafetyState,
    cause: Option<Cause>,
    clear_for: f64,
    /// Time for which the protective distance has been violated \[s\].
    violated_for: f64,
    waits: bool,
    unacknowledged: Option<Fault>,
    urgent: bool,
    /// True if a fault was reported since the last update.
    reported: bool,
    scale: f64,
    pressure: Pressure,
}

/// State of a contact force that was too large.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Pressure {
    Gone,
    Present,
}

impl Supervisor {
    /// Time for which a violation of the protective distance must last before the robot retreats
    /// \[s\]: two frames and a little, since one frame alone may show a head nearer. Until then the
    /// robot does not approach.
    pub(crate) const RETREAT_AFTER: f64 = 0.12;
    /// Additional room that is needed for recovery \[m\]: more than the 0.02 m to which a camera
    /// knows joints.
    pub const HYSTERESIS: f64 = 0.03;
    /// Time for which the cause must be gone before recovery \[s\]: four frames of a camera.
    pub const DWELL: f64 = 0.2;
    /// Share of the speed in the reduced state \[-\].
    pub(crate) const REDUCED_SCALE: f64 = 0.5;
    /// Share of the speed in retreat \[-\]: less than 0.25 m/s for a base of 1.5 m/s.
    pub const RETREAT_SCALE: f64 = 0.15;
    /// Time of the ramp from full speed to zero, and back \[s\]. Joints that cannot follow it brake at
    /// their limits.
    pub const RAMP: f64 = 0.25;

    /// Creates a supervisor in the normal state, at full speed.
    ///
    /// # Errors
    /// [`Error::Value`] if a setting is out of range.
    pub fn new(settings: SupervisorSettings) -> Result<Self, Error> {
        settings.validate()?;
        let state = SafetyState::Normal;
        Ok(Self {
            settings,
            state,
            cause: None,
            clear_for: 0.0,
            violated_for: 0.0,
            waits: false,
            unacknowledged: None,
            urgent: false,
            reported: false,
            scale: 1.0,
            pressure: Pressure::Gone,
        })
    }

    /// Returns the safety state.
    pub fn state(&self) -> SafetyState {
        self.state
    }

    /// Returns the latest cause of the state, a fault before its consequences. None in the normal
    /// state.
    pub fn cause(&self) -> Option<&Cause> {
        self.cause.as_ref()
    }

    /// Returns the share of its speed that the robot may use, 0 to 1. It follows a ramp.
    pub fn speed_scale(&self) -> f64 {
        self.scale
    }

    /// Returns true while the robot must stop as fast as it can, whatever the ramp of
    /// [`speed_scale`](Self::speed_scale) says. This holds for a fault, and while it moves towards
    /// a person who is too close.
    pub fn stops_at_once(&self) -> bool {
        self.urgent
    }

    /// Returns true if the current stop waits for [`acknowledge`](Self::acknowledge).
    pub fn waits_for_acknowledgement(&self) -> bool {
        self.waits
    }

    /// Returns the first fault that waits for [`acknowledge`](Self::acknowledge).
    pub fn unacknowledged(&self) -> Option<Fault> {
        self.unacknowledged
    }

    /// Acknowledges a stop, after a person has seen to its cause. The robot still recovers only
    /// when the cause is gone.
    pub fn acknowledge(&mut self) {
        self.waits = false;
        self.unacknowledged = None;
    }

    /// Reports a fault at any moment. Its state is entered at once, unless the state is stricter
    /// already. The fault counts as gone after an [`update`](Self::update) before which it was not
    /// reported again.
    pub fn report(&mut self, fault: Fault) {
        if fault.waits() {
            self.waits = true;
            self.unacknowledged = self.unacknowledged.or(Some(fault));
        }
        if fault.state() >= self.state {
            self.enter(fault.state(), Cause::Fault(fault));
            self.reported = true;
        }
    }

    /// Takes the force from outside in a tick, estimated from the joints' torques \[N\]. If it is
    /// above [`SupervisorSettings::contact_force`] or NaN, a fault is reported and returned.
    pub fn set_external_force(&mut self, force: f64) -> Option<Fault> {
        let limit = self.settings.contact_force;
        // Both comparisons are false for NaN.
        let (within, relieved) = (force <= limit, force <= 0.5 * limit);
        if !within {
            self.pressure = Pressure::Present;
        } else if relieved {
            self.pressure = Pressure::Gone;
        }
        let fault = (!within).then_some(Fault::ContactForce);
        if let Some(fault) = fault {
            self.report(fault);
        }
        fault
    }

    /// Returns true if the robot must give way to a force. This lasts from a force that was too
    /// large until the force has fallen to half of the limit.
    pub fn gives_way(&self) -> bool {
        self.pressure == Pressure::Present
    }

    /// Takes the observation of a tick, `period` \[s\] after the one before.
    ///
    /// A stricter state is entered at once. Recovery is one state at a time. It requires that the
    /// cause of the current state has been gone for the dwell time, with the hysteresis. A stop
    /// that must be acknowledged has to be.
    pub fn update(&mut self, observation: &Observation, period: f64) {
        // Recovery needs time to pass. Stricter states are entered even with an invalid period.
        let period = if period > 0.0 && period.is_finite() { period } else { 0.0 };
        if observation.nearest.is_some_and(|pair| pair.room().is_nan()) {
            self.report(Fault::BadData);
        }
        let violation = observation.nearest.filter(|pair| pair.room() < 0.0);
        self.violated_for = if violation.is_some() { self.violated_for + period } else { 0.0 };
        let is_glimpse = self.state < SafetyState::Retreat
            && self.violated_for > 0.0
            && self.violated_for < Self::RETREAT_AFTER;
        let nearest = observation.nearest.filter(|_| !is_glimpse);
        let observation = &Observation { nearest, ..*observation };
        let demanded = self.demand(observation, 0.0);
        if self.state < SafetyState::Retreat {
            self.urgent = violation.is_some_and(|pair| pair.approach > CREEP);
        }
        let faulty = std::mem::take(&mut self.reported);
        match demanded {
            Some((state, cause)) if state >= self.state => self.enter(state, cause),
            _ if self.state != SafetyState::Normal && !faulty => {
                self.urgent &= self.state == SafetyState::ProtectiveStop;
                let cautious = self.demand(observation, Self::HYSTERESIS);
                let better = cautious.is_none_or(|(state, _)| state < self.state);
                self.clear_for = if better { self.clear_for + period } else { 0.0 };
                if self.clear_for >= Self::DWELL && !self.waits {
                    self.recover(demanded.map(|(_, cause)| cause));
                }
            }
            _ => {}
        }
        let goal = match self.state {
            SafetyState::Normal => 1.0,
            SafetyState::Reduced => Self::REDUCED_SCALE,
            SafetyState::Retreat => Self::RETREAT_SCALE,
            SafetyState::ProtectiveStop => 0.0,
        };
        let step = period / Self::RAMP;
        self.scale += (goal - self.scale).clamp(-step, step);
    }

    fn enter(&mut self, state: SafetyState, cause: Cause) {
        let newly = self.state != state;
        let urgent = cause.is_urgent(state);
        if state == SafetyState::ProtectiveStop {
            self.waits |= newly && self.settings.acknowledge;
            self.urgent |= urgent;
        } else {
            self.urgent = urgent;
        }
        if newly || self.cause.is_none_or(|present| cause.rank() >= present.rank()) {
            self.cause = Some(cause);
        }
        self.state = state;
        self.clear_for = 0.0;
    }

    /// Recovers by one state. The cause is that of what is still demanded. Otherwise the cause of
    /// the stop stays until the normal state.
    fn recover(&mut self, demanded: Option<Cause>) {
        self.clear_for = 0.0;
        self.urgent = false;
        (self.state, self.cause) = match self.state {
            SafetyState::ProtectiveStop => (SafetyState::Retreat, demanded.or(self.cause)),
            SafetyState::Retreat => (SafetyState::Reduced, demanded.or(self.cause)),
            SafetyState::Reduced | SafetyState::Normal => (SafetyState::Normal, None),
        };
    }

    /// Returns the state that the observation demands, with `extra` room required. None for the
    /// normal state.
    fn demand(&self, observation: &Observation, extra: f64) -> Option<(SafetyState, Cause)> {
        use SafetyState::{ProtectiveStop, Reduced, Retreat};
        let settings = &self.settings;
        let Observation { nearest, age } = *observation;
        let room = nearest.map_or(f64::INFINITY, |pair| pair.room());
        if age.seconds() > settings.stop_age {
            return Some((ProtectiveStop, Cause::Stale { age }));
        }
        if let Some(pair) = nearest.filter(|_| room < extra) {
            return Some((Retreat, Cause::TooClose(pair)));
        }
        (age.seconds() > settings.reduced_age).then_some((Reduced, Cause::Stale { age }))
    }
}
