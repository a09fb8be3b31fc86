//! The safety state of the robot: what brought it there, and by which rule it recovers.

use crate::age::Age;
use crate::approach::Nearest;
use crate::error::{Error, not_negative, positive};
use crate::fault::Fault;

use crate::safety_state::SafetyState;

/// What brought the robot to its state.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Cause {
    /// The protective distance is undercut.
    TooClose(Nearest),
    /// People were not seen for too long.
    Stale {
        /// The age of the newest frame.
        age: Age,
    },
    /// The loop reported a fault.
    Fault(Fault),
}

impl Cause {
    /// Of causes that ask for the same state the one that says more: a fault before what follows
    /// from it.
    fn rank(&self) -> u8 {
        match self {
            Self::Fault(_) => 2,
            Self::TooClose(_) => 1,
            Self::Stale { .. } => 0,
        }
    }

    /// Returns true if the robot is to stop as fast as it can, and not along a ramp: for a fault that stops
    /// it, and while it still moves towards somebody who is too close.
    fn is_urgent(&self, state: SafetyState) -> bool {
        match self {
            Self::Fault(_) => state == SafetyState::ProtectiveStop,
            Self::TooClose(pair) => pair.approach > CREEP,
            Self::Stale { .. } => false,
        }
    }
}

/// A robot that comes nearer no faster than this does not approach \[m/s\].
const CREEP: f64 = 0.02;

/// When the states change.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct SupervisorSettings {
    /// By how much the protective distance may be undercut before the robot retreats, for noise
    /// \[m\]. Default 0.02.
    pub tolerance: f64,
    /// How long it must be undercut, for a head that one frame alone shows nearer \[s\]. Until then the robot comes no
    /// nearer. Default 0.12: two frames and a little.
    pub retreat_after: f64,
    /// Additional room needed to recover \[m\]. Default 0.1.
    pub hysteresis: f64,
    /// How long the reason must be gone to recover \[s\]. Default 0.5.
    pub dwell: f64,
    /// Age of the last percept from which speed is reduced \[s\]. Default 0.3.
    pub reduced_age: f64,
    /// Age of the last percept from which the robot stops \[s\]. Default 0.8.
    pub stop_age: f64,
    /// Whether somebody must acknowledge every protective stop before the robot recovers; some
    /// faults ask for that always, see [`Fault::waits`]. Default false.
    pub acknowledge: bool,
    /// Share of the speed when reduced \[-\]. Default 0.3.
    pub reduced_scale: f64,
    /// Share of the speed in retreat \[-\]. Default 0.15: of a base of 1.5 m/s less than 0.25 m/s.
    pub retreat_scale: f64,
    /// Time from full speed to none, and back \[s\]. Default 0.5.
    pub ramp: f64,
    /// Force from outside from which on the robot stops and gives way \[N\]; see
    /// [`Supervisor::feel`]. Default 60, below the least that a region of the body is to take at rest:
    /// 65 N on the face.
    pub contact_force: f64,
}

impl Default for SupervisorSettings {
    fn default() -> Self {
        Self {
            tolerance: 0.02,
            retreat_after: 0.12,
            hysteresis: 0.1,
            dwell: 0.5,
            reduced_age: 0.3,
            stop_age: 0.8,
            acknowledge: false,
            reduced_scale: 0.3,
            retreat_scale: 0.15,
            ramp: 0.5,
            contact_force: 60.0,
        }
    }
}

impl SupervisorSettings {
    /// Checks the ranges.
    ///
    /// # Errors
    /// [`Error::Value`] names the first that is out of its range.
    pub fn validate(&self) -> Result<(), Error> {
        not_negative("supervisor.tolerance", self.tolerance)?;
        not_negative("supervisor.retreat_after", self.retreat_after)?;
        not_negative("supervisor.hysteresis", self.hysteresis)?;
        not_negative("supervisor.dwell", self.dwell)?;
        positive("supervisor.reduced_age", self.reduced_age)?;
        positive("supervisor.ramp", self.ramp)?;
        positive("supervisor.contact_force", self.contact_force)?;
        if self.stop_age.is_nan() || self.stop_age < self.reduced_age {
            let (name, expected) = ("supervisor.stop_age", "at least supervisor.reduced_age");
            return Err(Error::Value { what: name, got: self.stop_age, wanted: expected });
        }
        for (name, value) in [
            ("supervisor.reduced_scale", self.reduced_scale),
            ("supervisor.retreat_scale", self.retreat_scale),
        ] {
            if !(0.0..=1.0).contains(&value) {
                return Err(Error::Value { what: name, got: value, wanted: "between 0 and 1" });
            }
        }
        Ok(())
    }
}

/// What a tick saw of people. It has no default: that nobody is near has to be seen.
///
/// ```compile_fail
/// let nobody = hrsw_safety::Observation::default();
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observation {
    /// The pair with the least room, from [`ApproachRows::write`](crate::ApproachRows::write);
    /// none with nobody there.
    pub nearest: Option<Nearest>,
    /// The age of the newest frame.
    pub age: Age,
}

/// Goes down at once, comes up by rule.
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
    /// How long the protective distance has been undercut \[s\].
    undercut_for: f64,
    waits: bool,
    unacknowledged: Option<Fault>,
    urgent: bool,
    /// Whether a fault was reported since the last update.
    reported: bool,
    scale: f64,
    pressure: Pressure,
}

/// Whether a force that was too large has gone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Pressure {
    Gone,
    Felt,
}

impl Supervisor {
    /// In the normal state, at full speed.
    ///
    /// # Errors
    /// [`Error::Value`] for settings out of range.
    pub fn new(settings: SupervisorSettings) -> Result<Self, Error> {
        settings.validate()?;
        let state = SafetyState::Normal;
        Ok(Self {
            settings,
            state,
            cause: None,
            clear_for: 0.0,
            undercut_for: 0.0,
            waits: false,
            unacknowledged: None,
            urgent: false,
            reported: false,
            scale: 1.0,
            pressure: Pressure::Gone,
        })
    }

    /// How much the robot may do.
    pub fn state(&self) -> SafetyState {
        self.state
    }

    /// What brought it to its state, as seen last, a fault before what follows from it; none in the
    /// normal state.
    pub fn cause(&self) -> Option<&Cause> {
        self.cause.as_ref()
    }

    /// The share of its speed that the robot may use, 0 to 1, ramped.
    pub fn speed_scale(&self) -> f64 {
        self.scale
    }

    /// Returns true while the robot is to stop as fast as it can, whatever
    /// [`speed_scale`](Self::speed_scale) is on its ramp: for a fault, and as long as it moves towards
    /// somebody who is too close.
    pub fn stops_at_once(&self) -> bool {
        self.urgent
    }

    /// Returns true if the present stop waits for [`acknowledge`](Self::acknowledge).
    pub fn waits_for_acknowledgement(&self) -> bool {
        self.waits
    }

    /// The first fault that waits for [`acknowledge`](Self::acknowledge).
    pub fn unacknowledged(&self) -> Option<Fault> {
        self.unacknowledged
    }

    /// Somebody has seen to the reason of a stop. The robot still recovers only once the reason
    /// is gone.
    pub fn acknowledge(&mut self) {
        self.waits = false;
        self.unacknowledged = None;
    }

    /// Takes a fault, at any moment: its state is entered at once. It counts as gone from the first
    /// [`update`](Self::update) on before which it was not reported again.
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

    /// Takes the force from outside that a tick felt \[N\], as estimated from the joints' torques. Above
    /// [`SupervisorSettings::contact_force`], or no number, it is reported as a fault, which is returned.
    pub fn feel(&mut self, force: f64) -> Option<Fault> {
        let limit = self.settings.contact_force;
        // No number is neither.
        let (within, relieved) = (force <= limit, force <= 0.5 * limit);
        if !within {
            self.pressure = Pressure::Felt;
        } else if relieved {
            self.pressure = Pressure::Gone;
        }
        let fault = (!within).then_some(Fault::ContactForce);
        if let Some(fault) = fault {
            self.report(fault);
        }
        fault
    }

    /// Returns true if the robot is to give way to a force: from when it was too large until it has fallen
    /// to half of that.
    pub fn gives_way(&self) -> bool {
        self.pressure == Pressure::Felt
    }

    /// Takes what a tick observed, `period` \[s\] after the one before.
    ///
    /// A worse state is entered at once. A better one is entered, one step at a time, when what
    /// asks for the present one has been gone for the dwell time, with the hysteresis, and a
    /// stop that must be acknowledged has been.
    pub fn update(&mut self, observation: &Observation, period: f64) {
        // Without time nothing recovers; a worse state is still entered.
        let period = if period > 0.0 && period.is_finite() { period } else { 0.0 };
        if observation.nearest.is_some_and(|pair| pair.room().is_nan()) {
            self.report(Fault::BadData);
        }
        let tolerance = self.settings.tolerance;
        let undercut = observation.nearest.filter(|pair| pair.room() < -tolerance);
        self.undercut_for = if undercut.is_some() { self.undercut_for + period } else { 0.0 };
        let is_glimpse = self.state < SafetyState::Retreat
            && self.undercut_for > 0.0
            && self.undercut_for < self.settings.retreat_after;
        let nearest = observation.nearest.filter(|_| !is_glimpse);
        let observation = &Observation { nearest, ..*observation };
        let demanded = self.demand(observation, 0.0);
        if self.state < SafetyState::Retreat {
            self.urgent = undercut.is_some_and(|pair| pair.approach > CREEP);
        }
        let faulty = std::mem::take(&mut self.reported);
        match demanded {
            Some((state, cause)) if state >= self.state => self.enter(state, cause),
            _ if self.state != SafetyState::Normal && !faulty => {
                self.urgent &= self.state == SafetyState::ProtectiveStop;
                let cautious = self.demand(observation, self.settings.hysteresis);
                let better = cautious.is_none_or(|(state, _)| state < self.state);
                self.clear_for = if better { self.clear_for + period } else { 0.0 };
                if self.clear_for >= self.settings.dwell && !self.waits {
                    self.recover(demanded.map(|(_, cause)| cause));
                }
            }
            _ => {}
        }
        let goal = match self.state {
            SafetyState::Normal => 1.0,
            SafetyState::Reduced => self.settings.reduced_scale,
            SafetyState::Retreat => self.settings.retreat_scale,
            SafetyState::ProtectiveStop => 0.0,
        };
        let step = period / self.settings.ramp;
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

    /// One step up, with the cause of what is still demanded; without one that of the stop stays
    /// until normal.
    fn recover(&mut self, demanded: Option<Cause>) {
        self.clear_for = 0.0;
        self.urgent = false;
        (self.state, self.cause) = match self.state {
            SafetyState::ProtectiveStop => (SafetyState::Retreat, demanded.or(self.cause)),
            SafetyState::Retreat => (SafetyState::Reduced, demanded.or(self.cause)),
            SafetyState::Reduced | SafetyState::Normal => (SafetyState::Normal, None),
        };
    }

    /// The state that the observation asks for, with `extra` room demanded; none for normal.
    fn demand(&self, observation: &Observation, extra: f64) -> Option<(SafetyState, Cause)> {
        use SafetyState::{ProtectiveStop, Reduced, Retreat};
        let settings = &self.settings;
        let Observation { nearest, age } = *observation;
        let room = nearest.map_or(f64::INFINITY, |pair| pair.room());
        if age.seconds() > settings.stop_age {
            return Some((ProtectiveStop, Cause::Stale { age }));
        }
        if let Some(pair) = nearest.filter(|_| room < extra - settings.tolerance) {
            return Some((Retreat, Cause::TooClose(pair)));
        }
        (age.seconds() > settings.reduced_age).then_some((Reduced, Cause::Stale { age }))
    }
}
