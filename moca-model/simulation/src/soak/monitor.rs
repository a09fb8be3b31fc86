//! The checks of every tick.

use hrsw_safety::{Capsule, SafetyState};
use moca_model::whole_body::{FrameId, Model};
use moca_model::{Command, ControllerSettings};
use serde::{Deserialize, Serialize};

use super::disturbance::{Disturbance, Endings};
use crate::error::Error;
use crate::judges::{LimitMonitor, Moment, Return, SeparationMonitor, is_unseen};
use crate::plant::{rod, separation_monitor};

/// Ticks with something wrong, by kind, and two kinds that are not wrong but worth counting.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Counts {
    /// The hierarchy was not solved to its optimum.
    pub infeasible: u64,
    /// A number of the command is not finite.
    pub not_finite: u64,
    /// A limit of position or velocity is violated.
    pub limit_violations: u64,
    /// An acceleration limit of a joint is violated.
    pub acceleration_violations: u64,
    /// A jerk limit of a joint is violated.
    pub jerk_violations: u64,
    /// A torque, or its change, is too large.
    pub torque_violations: u64,
    /// The robot moves towards a person who is too near, and is not the person's own doing.
    pub separation_violations: u64,
    /// The velocity of the desired pose changes faster than its limit.
    pub discontinuities: u64,
    /// Bodies of the robot that are to keep apart overlap.
    pub self_collisions: u64,
    /// The robot is too near to a person by that person's own motion.
    pub person_caused: u64,
    /// The robot comes nearer to a person who works with it.
    pub contact: u64,
    /// Something is wrong with the loop, and the robot may do more than the book says.
    pub wrong_states: u64,
}

impl Counts {
    /// The sum of all that must be zero.
    pub fn wrong(&self) -> u64 {
        self.infeasible
            + self.not_finite
            + self.limit_violations
            + self.acceleration_violations
            + self.jerk_violations
            + self.torque_violations
            + self.separation_violations
            + self.discontinuities
            + self.self_collisions
            + self.wrong_states
    }
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.infeasible += other.infeasible;
        self.not_finite += other.not_finite;
        self.limit_violations += other.limit_violations;
        self.acceleration_violations += other.acceleration_violations;
        self.jerk_violations += other.jerk_violations;
        self.torque_violations += other.torque_violations;
        self.separation_violations += other.separation_violations;
        self.discontinuities += other.discontinuities;
        self.self_collisions += other.self_collisions;
        self.person_caused += other.person_caused;
        self.contact += other.contact;
        self.wrong_states += other.wrong_states;
    }
}

/// Events of a tick.
#[derive(Clone, Copy, Debug)]
pub struct Tick<'a> {
    /// The controller's answer.
    pub command: &'a Command,
    /// Configuration of the robot \[m, rad\].
    pub configuration: &'a [f64],
    /// Configuration at which the command begins \[m, rad\].
    pub reference: &'a [f64],
    /// True if torques broke a limit; none without torques.
    pub breaks_torque: Option<bool>,
    /// Everybody.
    pub people: &'a [Moment<'a>],
    /// Disturbance of the loop at present, and its duration so far \[s\].
    pub disturbance: Option<(Disturbance, f64)>,
}

/// Checks every tick of an episode.
#[derive(Clone, Debug)]
pub struct Monitor {
    separation: SeparationMonitor,
    limits: LimitMonitor,
    /// Counts of findings so far.
    pub counts: Counts,
    /// Endings of disturbances.
    pub ended: Endings,
    period: f64,
    /// Path commanded since measurements are frozen \[rad or m\], and how long it has been too short to notice \[s\].
    frozen_path: f64,
    hidden: f64,
    /// True if the tick before had no time, or no measurement.
    was_blind: bool,
    /// Ticks left in which joints may be outside their ranges by a push.
    settling: u64,
    /// Largest overlap of the robot's own bodies that a push has brought together, from this time on \[m\].
    pushed_overlap: f64,
    /// Speeds of the robot's own approach to parts within 5 cm that it may touch, tick by tick \[m/s\].
    pub contact_speeds: Vec<f64>,
    /// The first tick with something wrong, and what is known of it.
    pub first_wrong: Option<String>,
}

impl Monitor {
    /// Creates the monitor of a robot at rest.
    ///
    /// # Errors
    /// Bodies on links that the robot does not have.
    pub fn new(
        model: &Model,
        settings: &ControllerSettings,
        configuration: &[f64],
    ) -> Result<Self, Error> {
        let period = settings.period;
        Ok(Self {
            separation: separation_monitor(model, settings)?,
            limits: LimitMonitor::new(model, settings, configuration),
            counts: Counts::default(),
            ended: Endings::default(),
            settling: 0,
            pushed_overlap: 0.0,
            period,
            frozen_path: 0.0,
            hidden: 0.0,
            was_blind: false,
            contact_speeds: Vec::new(),
            first_wrong: None,
        })
    }

    /// The robot holds this, too, in the frame `tool`.
    pub fn carry(&mut self, tool: FrameId, object: &Capsule) {
        self.separation.carry(tool, rod(object));
    }

    /// Takes a period in which the controller had no turn.
    pub fn miss(&mut self) {
        self.limits.miss();
    }

    /// Returns how long what is wrong at present could not be noticed \[s\]. A frozen measurement equals a measured
    /// one while the robot stands.
    fn hidden_time(&mut self, tick: &Tick<'_>) -> f64 {
        let Some((Disturbance::MeasurementFrozen, lasts)) = tick.disturbance else {
            (self.frozen_path, self.hidden) = (0.0, 0.0);
            return 0.0;
        };
        let speeds = tick.command.joint_velocity.iter().map(|velocity| velocity.abs());
        self.frozen_path += speeds.fold(0.0, f64::max) * self.period;
        if self.frozen_path < NOTICEABLE {
            self.hidden = lasts;
        }
        self.hidden
    }

    /// Checks a tick.
    ///
    /// # Errors
    /// A configuration that is not one of the robot.
    pub fn check(&mut self, tick: &Tick<'_>) -> Result<(), Error> {
        let command = tick.command;
        let is_settling = self.settle(tick);
        let hidden = self.hidden_time(tick);
        let counts = &mut self.counts;
        let blind = tick.disturbance.is_some_and(|(what, _)| what.leaves_nothing_to_solve());
        // The tick after a wrong time has no time either.
        let was_blind = std::mem::replace(&mut self.was_blind, blind);
        let could_solve = !blind && !was_blind;
        if let Some((disturbance, lasts)) = tick.disturbance {
            let least = disturbance.least_state(lasts - hidden);
            counts.wrong_states += u64::from(command.safety < least);
        }
        counts.infeasible += u64::from(!command.outcome.is_optimal() && could_solve);
        if !is_finite(command) {
            counts.not_finite += 1;
            return Ok(());
        }

        let knows_nobody = tick.people.iter().all(|moment| moment.known.is_none());
        let free = command.safety == SafetyState::Normal && knows_nobody;
        let returning = if free { Return::Free } else { Return::Hindered };
        let breaches = self.limits.check(command, tick.reference, returning);
        counts.limit_violations += u64::from(breaches.limit || breaches.range && !is_settling);
        counts.acceleration_violations += u64::from(breaches.acceleration);
        counts.jerk_violations += u64::from(breaches.jerk);
        counts.torque_violations += u64::from(tick.breaks_torque == Some(true));
        counts.discontinuities += u64::from(breaches.desired_acceleration);

        let velocity = &command.joint_velocity;
        let verdict = self.separation.check(velocity, tick.configuration, tick.people)?;
        let collides = self.collides(is_settling, tick.reference)?;
        let counts = &mut self.counts;
        counts.separation_violations += u64::from(verdict.violation.is_some());
        counts.person_caused += u64::from(verdict.person_caused);
        counts.contact += u64::from(verdict.contact);
        self.contact_speeds.extend(verdict.contact_speed);
        counts.self_collisions += u64::from(collides);
        if self.first_wrong.is_none() && self.counts.wrong() > 0 {
            let blame = verdict.violation;
            let Command { outcome, fault, .. } = command;
            self.first_wrong = Some(format!(
                "{outcome:?} {fault:?} {breaches:?} {blame:?} {:?}; {:?}",
                tick.disturbance, self.counts
            ));
        }
        Ok(())
    }

    /// Returns true if the robot has moved its own bodies into each other. Those that a push has brought
    /// together may stay where it left them, as long as the robot does not press them together: they come no nearer than
    /// they were, or were commanded to be.
    fn collides(&mut self, is_settling: bool, commanded: &[f64]) -> Result<bool, Error> {
        let overlap = self.separation.overlap();
        if is_settling {
            self.pushed_overlap = overlap;
        } else if self.pushed_overlap > 0.0 && overlap <= self.pushed_overlap + SAGGING {
            // An arm that has overshot comes back to its command.
            let commanded = self.separation.overlap_at(commanded)?;
            self.pushed_overlap = self.pushed_overlap.min(overlap.max(commanded));
        } else {
            return Ok(overlap > 0.0);
        }
        Ok(false)
    }

    /// Checks whether a joint may leave its range: somebody pushes it, or the robot brakes by itself or unseen. Returns
    /// true during that time and the braking after it.
    fn settle(&mut self, tick: &Tick<'_>) -> bool {
        use Disturbance::{ArmPushed, CommandsLost, MeasurementFrozen, MeasurementMissing};
        let disturbance = tick.disturbance.map(|(disturbance, _)| disturbance);
        if let Some(ArmPushed | CommandsLost | MeasurementMissing | MeasurementFrozen) = disturbance
        {
            self.settling = SETTLING;
        }
        let is_settling = self.settling > 0;
        self.settling = self.settling.saturating_sub(1);
        // A command that takes a joint farther out still counts.
        if is_settling || is_unseen(tick.command) {
            self.limits.move_outside(tick.reference);
        } else {
            self.limits.restart(tick.reference, tick.configuration);
        }
        is_settling
    }
}

/// Commanded path beyond which frozen measurements are told from a robot that stands \[rad or m\].
const NOTICEABLE: f64 = 1e-3;

/// A robot that gives a little under its own weight comes no nearer to itself than this \[m\].
const SAGGING: f64 = 1e-3;

/// Ticks after a push in which joints may still brake that it took out of their ranges.
const SETTLING: u64 = 500;

fn is_finite(command: &Command) -> bool {
    let numbers = command
        .joint_velocity
        .iter()
        .chain(&command.joint_position)
        .chain(&command.base_twist)
        .chain(command.desired_twist.iter())
        .chain(command.slack.iter())
        .chain(command.desired.translation.vector.iter())
        .chain(command.desired.rotation.coords.iter());
    numbers.into_iter().all(|number| number.is_finite())
}
