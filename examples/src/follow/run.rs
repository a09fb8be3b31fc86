//! One run of the loop.

use std::time::Instant;

use ergo_map::PersonFrame;
use hrsw::{SafetyState, Workspace};
use moca_model::{Command, Controller, ControllerSettings, Goal, HeldObject, Phase};
use nalgebra::Vector3;
use vision_models::{Body, Percept};

use super::on_board::OnBoardEye;
use super::scenario::{Delivery, Scenario};
use super::scoring::Scorer;
use super::seen::{SeenOthers, SeenPerson};
use super::summary::{MeasuredReba, Summary};
use super::true_person::TruePerson;
use super::work::WorkForce;
use super::working_hand::WorkingHand;
use crate::program::{Ending, Interrupt};
use crate::separation::{Moment, SeparationMonitor};
use human_perception::percepts::{Assessor, MeasuredAssessment};
use moca_replay::recorded::Recorder;
use moca_replay::report::TickRow;
use moca_simulation::limits::{LimitMonitor, Return};
use moca_simulation::plant::Plant;

/// A margin below which x_d counts as within the workspace \[m or rad\].
const INSIDE: f64 = 1e-3;

/// Of the robot's noise, the same in both runs.
const SEED: u64 = 1;

/// One controller against the simulated robot.
#[derive(Debug)]
pub struct Run<'a> {
    scenario: &'a Scenario,
    scorer: Scorer<'a>,
    assessor: Assessor,
    /// In the newest percept.
    measured: Option<MeasuredAssessment>,
    plant: Plant,
    on_board: OnBoardEye,
    work: WorkForce,
    hand: WorkingHand,
    monitor: LimitMonitor,
    person: SeenPerson,
    /// By whom distances are judged, where that is known.
    true_person: Option<TruePerson<'a>>,
    others: SeenOthers,
    separation: SeparationMonitor,
    period: f64,
    engaged: bool,
    state: SafetyState,
    tally: Tally,
    ticks_us: Vec<f64>,
    interrupt: Interrupt,
    recorder: Option<&'a mut Recorder>,
}

/// Sums over ticks.
#[derive(Debug, Default)]
struct Tally {
    ticks: u64,
    together: u64,
    score: f64,
    score_max: f64,
    reba: f64,
    reba_max: u8,
    /// Ticks of those with a measured posture.
    measured: u64,
    reba_measured: f64,
    reba_measured_max: u8,
    error_squared: f64,
    outside: u64,
    out_of_reach: u64,
    violations: u64,
    jerk_violations: u64,
    /// None where there are no torques.
    torque_violations: Option<u64>,
    /// How often a protective stop began, and a retreat.
    stops: u64,
    retreats: u64,
    separation_violations: u64,
    /// One element a tick with a part of the true person within 5 cm that may be touched \[m/s\].
    contact_speeds: Vec<f64>,
    failures: u64,
}

impl<'a> Run<'a> {
    /// A run from the beginning.
    ///
    /// # Errors
    /// Settings that the controller refuses.
    pub fn new(scenario: &'a Scenario, goal: Goal) -> anyhow::Result<Self> {
        let settings = ControllerSettings { goal, ..scenario.settings.clone() };
        let (period, desired) = (settings.period, settings.desired);
        let start = &scenario.start;
        let controller =
            Controller::new(scenario.model.clone(), scenario.comfort, settings, start)?;
        let safety = &scenario.settings.safety;
        let separation = SeparationMonitor::new(&scenario.model, safety, period)?;
        let torques = scenario.torques.clone();
        let plant = Plant::with_torques(scenario.drive, controller, torques, SEED)?;
        let mut run = Self {
            on_board: OnBoardEye::new(SEED),
            scorer: Scorer::new(&scenario.map),
            assessor: Assessor::new(scenario.posture),
            measured: None,
            plant,
            work: WorkForce::default(),
            hand: WorkingHand::new(scenario.map.stature(), scenario.map.side()),
            monitor: LimitMonitor::new(&scenario.model, desired, period, start),
            person: SeenPerson::default(),
            true_person: scenario.truth.as_ref().map(|motion| TruePerson::new(motion, period)),
            others: SeenOthers::default(),
            separation,
            period,
            engaged: false,
            state: SafetyState::Normal,
            tally: Tally::default(),
            ticks_us: Vec::new(),
            interrupt: Interrupt::default(),
            recorder: None,
            scenario,
        };
        if let Delivery::Held = scenario.delivery {
            run.hold(&scenario.object)?;
        }
        Ok(run)
    }

    /// The same, but it ends early when an interrupt comes.
    #[must_use]
    pub fn until(mut self, interrupt: Interrupt) -> Self {
        self.interrupt = interrupt;
        self
    }

    /// The same, with a recorder that sees every camera frame and every tick.
    #[must_use]
    pub fn recorded_by(mut self, recorder: &'a mut Recorder) -> Self {
        self.recorder = Some(recorder);
        self
    }

    /// Plays the scenario to its end, or to an interrupt; `each` sees every tick.
    ///
    /// # Errors
    /// Percepts out of order, and whatever `each` fails with.
    pub fn play(
        self,
        mut each: impl FnMut(&TickRow) -> anyhow::Result<()>,
    ) -> anyhow::Result<Summary> {
        self.play_watched(|row, _| each(row))
    }

    /// The same, but `each` sees the robot, too, as it is when the tick is over.
    ///
    /// # Errors
    /// As [`play`](Self::play).
    pub fn play_watched(
        mut self,
        mut each: impl FnMut(&TickRow, &mut Plant) -> anyhow::Result<()>,
    ) -> anyhow::Result<Summary> {
        let begin = self.scenario.percepts.first().map_or(0.0, |percept| percept.time);
        let duration = self.scenario.duration();
        let percepts = self.scenario.percepts.iter().zip(&self.scenario.arrivals);
        let mut percepts = percepts.enumerate().peekable();
        let started = Instant::now();
        let mut elapsed = 0.0;
        let mut ending = Ending::Complete;
        while elapsed <= duration {
            if self.interrupt.requested() {
                ending = Ending::Partial;
                break;
            }
            let has_come = |(_, (_, at)): &(usize, (&Percept, &f64))| **at <= begin + elapsed;
            while let Some((frame, (percept, _))) = percepts.next_if(has_come) {
                let (shown, others) = (self.hand.show(percept), self.scenario.others(frame));
                self.observe(&shown, others)?;
                self.adapt()?;
                let least_confidence = self.scenario.settings.safety.person.least_confidence;
                let person = percept.body.as_ref();
                self.others.update(percept.time, person, others, least_confidence);
                if let Some(body) = &shown.body {
                    self.person.update(percept.time, body, least_confidence);
                    if let Some(person) = &mut self.true_person {
                        person.show(percept.time, &self.hand);
                    }
                }
                self.measured = match &percept.body {
                    Some(body) => self.assessor.update(percept.time, body)?,
                    None => None,
                };
                if let Some(recorder) = &mut self.recorder {
                    let measured =
                        self.measured.map(|measured| (measured.side, measured.reba.sub_scores));
                    recorder.observe(&shown, others, measured);
                }
            }
            let row = self.tick(begin + elapsed)?;
            each(&row, &mut self.plant)?;
            #[expect(clippy::cast_precision_loss, reason = "ticks count far below 2^52")]
            let time = self.tally.ticks as f64 * self.period;
            elapsed = time;
        }
        let wall = started.elapsed().as_secs_f64();
        Ok(self.summary(elapsed.min(duration), wall, ending))
    }

    fn observe(&mut self, percept: &Percept, others: &[Body]) -> anyhow::Result<()> {
        let taken = match &self.scenario.delivery {
            Delivery::Held => self.plant.observe_people(percept, others),
            Delivery::HandedOver { .. } => {
                let surface = self.on_board.look(&mut self.plant, self.scenario)?;
                self.plant.observe_people(&Percept { surface, ..percept.clone() }, others)
            }
        };
        // Too many people, or a body that is nobody's, stop the robot; the run goes on.
        taken.or_else(|error| match error.downcast_ref() {
            Some(moca_model::Error::TooManyPeople { .. } | moca_model::Error::Body { .. }) => {
                Ok(())
            }
            _ => Err(error),
        })
    }

    /// Closes the gripper when the object is there.
    fn grasp(&mut self) -> anyhow::Result<()> {
        match &self.scenario.delivery {
            Delivery::HandedOver { believed } if self.plant.command().phase == Phase::Grasping => {
                self.hold(believed)
            }
            _ => Ok(()),
        }
    }

    /// The robot holds the object, and takes it for this.
    fn hold(&mut self, believed: &HeldObject) -> anyhow::Result<()> {
        let tool = self.plant.controller().robot().tool();
        self.separation.carry(tool, &[self.scenario.object.capsule()?]);
        self.plant.hold(believed)
    }

    /// Has the controller minimise the ergonomics of somebody of the stature that was measured.
    fn adapt(&mut self) -> anyhow::Result<()> {
        let Some(stature) = self.scenario.adapts_from else { return Ok(()) };
        if let Some(measured) = self.plant.controller().space().stature() {
            let comfort = self.scenario.comfort.resized(measured.stature / stature)?;
            self.plant.controller_mut().set_comfort(comfort);
        }
        Ok(())
    }

    fn tick(&mut self, now: f64) -> anyhow::Result<TickRow> {
        let tick_us = self.plant.step(now)?;
        let actual = self.plant.hand()?.translation.vector;
        let (command, space) = (self.plant.command(), self.plant.controller().space());
        let undisturbed = command.safety == SafetyState::Normal && space.person().is_none();
        let returning = if undisturbed { Return::Free } else { Return::Hindered };
        let breaches = self.monitor.check(command, self.plant.reference(), returning);

        let violation = space.workspace().violation(&command.desired);
        let inside = violation.amax() <= INSIDE;
        // Working together begins when the tool first arrives in the shared workspace.
        self.engaged = space.is_shared() && (self.engaged || inside);
        let mut row = row(command, now, tick_us, &actual);
        row.q.copy_from_slice(self.plant.configuration());
        (row.workspace_min, row.workspace_max) = extent(space.workspace());
        row.collaborating = self.engaged;
        let hand = space.person().and_then(|person| {
            let floor = Vector3::new(person.floor.x, person.floor.y, 0.0);
            let frame = PersonFrame::new(floor, person.heading).ok()?;
            self.scorer.score(&frame, &actual)
        });
        if let Some(hand) = hand {
            row.score = hand.score;
            row.reba = hand.reba;
        }
        let begins = |state| command.safety == state && self.state != state;
        let (stops, retreats) = (begins(SafetyState::ProtectiveStop), begins(SafetyState::Retreat));
        row.reba_measured = self.measured.map(|measured| measured.reba.reba);
        self.move_person(now, &actual);
        let too_near = self.is_too_near()?;
        let command = self.plant.command();
        let tally = &mut self.tally;
        tally.separation_violations += u64::from(too_near);
        if let (true, Some(reba)) = (self.engaged, row.reba_measured) {
            tally.measured += 1;
            tally.reba_measured += f64::from(reba);
            tally.reba_measured_max = tally.reba_measured_max.max(reba);
        }
        tally.ticks += 1;
        tally.violations += u64::from(breaches.any());
        tally.jerk_violations += u64::from(breaches.jerk);
        tally.stops += u64::from(stops);
        tally.retreats += u64::from(retreats);
        if let Some(breaks) = self.plant.breaks_torque_limits() {
            tally.torque_violations =
                Some(tally.torque_violations.unwrap_or_default() + u64::from(breaks));
        }
        tally.failures += u64::from(!command.outcome.is_optimal());
        tally.error_squared += (command.desired.translation.vector - actual).norm_squared();
        if let (true, Some(hand)) = (self.engaged, hand) {
            tally.together += 1;
            tally.score += hand.score;
            tally.score_max = tally.score_max.max(hand.score);
            tally.reba += f64::from(hand.reba);
            tally.reba_max = tally.reba_max.max(hand.reba);
            tally.outside += u64::from(!inside);
            tally.out_of_reach += u64::from(!hand.reached);
        }
        if let Some(recorder) = &mut self.recorder {
            recorder.tick(self.plant.controller(), self.plant.configuration(), &row)?;
        }
        self.state = command.safety;
        self.ticks_us.push(tick_us);
        let towards =
            self.plant.controller().space().person().map(|person| {
                Vector3::new(actual.x - person.floor.x, actual.y - person.floor.y, 0.0)
            });
        let force = self.work.advance(towards.filter(|_| self.engaged), self.period);
        self.plant.act(&force)?;
        self.grasp()?;
        Ok(row)
    }

    /// The person's hand follows the tool, at `actual` \[m\], as long as they work on it.
    fn move_person(&mut self, now: f64, actual: &Vector3<f64>) {
        if let Some(joints) = self.scenario.truth.as_ref().and_then(|motion| motion.at(now)) {
            self.hand.follow(&joints);
        }
        self.hand.advance(now, self.period, Some(*actual).filter(|_| self.engaged));
        if let Some(person) = &mut self.true_person {
            person.advance(now, &self.hand);
        }
    }

    /// Returns true if the robot comes nearer to anybody than it may: to the true person, or where nobody knows
    /// that, to the one whom the percepts show; to others as they are seen.
    fn is_too_near(&mut self) -> anyhow::Result<bool> {
        if !self.scenario.has_separation() {
            return Ok(false);
        }
        let contact = self.plant.controller().safety().contact_speed() > 0.0;
        let (velocity, start) = (&self.plant.command().joint_velocity, self.plant.reference());
        let seen = self.person.joints().map(|now| (self.person.before(&now, self.period), now));
        let moment = if let Some(person) = &self.true_person {
            person.moment(contact)
        } else {
            seen.as_ref().map(|(before, now)| {
                let person = (now, Some(before));
                Moment { person, known: Some(person), contact }
            })
        };
        let others = self.others.joints(self.period);
        let others = others.iter().map(|(before, now)| {
            let person = (now, Some(before));
            Moment { person, known: Some(person), contact: false }
        });
        let people: Vec<Moment<'_>> = moment.into_iter().chain(others).collect();
        if people.is_empty() {
            return Ok(false);
        }
        let verdict = self.separation.check(velocity, start, &people)?;
        let contact_speed = verdict.contact_speed.filter(|_| self.true_person.is_some());
        self.tally.contact_speeds.extend(contact_speed);
        Ok(verdict.violation.is_some())
    }

    #[expect(clippy::cast_precision_loss, reason = "ticks count far below 2^52")]
    fn summary(mut self, duration: f64, wall: f64, ending: Ending) -> Summary {
        let contact_speed = quantile(&mut self.tally.contact_speeds, 999);
        let tally = &self.tally;
        let share = |sum: f64, ticks: u64| if ticks == 0 { 0.0 } else { sum / ticks as f64 };
        let time = |ticks: u64| ticks as f64 * self.period;
        let tick_us = [500, 990, 1000]
            .map(|thousandths| quantile(&mut self.ticks_us, thousandths).unwrap_or_default());
        Summary {
            ending,
            duration,
            together: time(tally.together),
            score_mean: share(tally.score, tally.together),
            score_max: tally.score_max,
            reba_mean: share(tally.reba, tally.together),
            reba_max: tally.reba_max,
            reba_measured: (tally.measured > 0).then(|| MeasuredReba {
                mean: share(tally.reba_measured, tally.measured),
                max: tally.reba_measured_max,
            }),
            tracking_error_rms_mm: 1e3 * share(tally.error_squared, tally.ticks).sqrt(),
            outside: time(tally.outside),
            out_of_reach: time(tally.out_of_reach),
            margins: self.monitor.margins(),
            limit_violations: tally.violations,
            jerk_violations: tally.jerk_violations,
            torque_violations: tally.torque_violations,
            protective_stops: tally.stops,
            retreats: tally.retreats,
            truth: self.true_person.is_some(),
            separation_violations: tally.separation_violations,
            contact_speed,
            solver_failures: tally.failures,
            tick_us,
            wall,
        }
    }
}

/// The value that so many thousandths of all do not exceed; none of none.
fn quantile(values: &mut [f64], thousandths: usize) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let last = values.len().checked_sub(1)?;
    values.get((values.len() * thousandths / 1000).min(last)).copied()
}

/// The parts of a row that the command holds.
fn row(command: &Command, now: f64, tick_us: f64, actual: &Vector3<f64>) -> TickRow {
    let mut row = TickRow {
        time: now,
        desired: command.desired.translation.vector.into(),
        actual: (*actual).into(),
        slack: command.slack.into(),
        solve_time_us: tick_us,
        ..TickRow::default()
    };
    row.qdot.copy_from_slice(&command.joint_velocity);
    row
}

/// The box along world axes around the workspace.
fn extent(workspace: &Workspace) -> ([f64; 3], [f64; 3]) {
    let bounds = workspace.position();
    let centre = (bounds.min() + bounds.max()) * 0.5;
    let half = (bounds.max() - bounds.min()) * 0.5;
    let frame = workspace.world_from_workspace();
    let middle = frame.transform_point(&centre.into()).coords;
    let reach = frame.rotation.to_rotation_matrix().matrix().abs() * half;
    ((middle - reach).into(), (middle + reach).into())
}
