//! A run of the loop.

use std::ops::ControlFlow;
use std::time::Instant;

use ergo_map::{ErgonomicsMap, PersonFrame};
use hrsw_safety::{Cause, SafetyState};
use human_perception::percepts::{Assessor, MeasuredAssessment};
use moca_model::{
    Controller, ControllerSettings, Goal, GraspedObject, MOCA_BASE_JOINTS, Phase, Scene,
};
use moca_replay::recorded::Recorder;
use moca_replay::report::{TickRow, Together};
use nalgebra::Vector3;
use vision_models::{Body, Percept};

use super::encounter::Encounter;
use super::on_board::RobotView;
use super::scenario::{Delivery, Scenario};
use super::scoring::Scorer;
use super::seen::{SeenOthers, SeenPerson};
use super::summary::Summary;
use super::tally::{Played, Tally};
use super::tick_row::tick_row;
use super::true_person::TruePerson;
use super::work::WorkForce;
use crate::error::Error;
use crate::judges::{Calmness, CalmnessMonitor, LimitMonitor, Moment, Return, SeparationMonitor};
use crate::plant::{Plant, rod, separation_monitor};

/// Seed of the robot's noise, the same in both runs.
const SEED: u64 = 1;

/// A controller in a loop with the simulated robot.
#[derive(Debug)]
pub struct Run<'a> {
    scenario: &'a Scenario,
    scorer: Scorer<&'a ErgonomicsMap>,
    assessor: Assessor,
    /// Assessment of the newest percept.
    measured: Option<MeasuredAssessment>,
    plant: Plant,
    work: WorkForce,
    encounter: Encounter,
    monitor: LimitMonitor,
    person: SeenPerson,
    /// The true person, by which distances are judged if it is known.
    true_person: Option<TruePerson<'a>>,
    others: SeenOthers,
    separation: SeparationMonitor,
    calmness: CalmnessMonitor,
    period: f64,
    engaged: Together,
    state: SafetyState,
    tally: Tally,
    recorder: Option<&'a mut Recorder>,
}

impl<'a> Run<'a> {
    /// Creates a run from the beginning.
    ///
    /// # Errors
    /// Settings that the controller refuses.
    pub fn new(scenario: &'a Scenario, goal: Goal) -> Result<Self, Error> {
        let settings = ControllerSettings { goal, ..scenario.settings.clone() };
        let period = settings.period;
        let monitor = LimitMonitor::new(&scenario.model, &settings, &scenario.start);
        let start = &scenario.start;
        let controller =
            Controller::new(scenario.model.clone(), scenario.ergonomics, settings, start)?;
        let separation = separation_monitor(&scenario.model, &scenario.settings)?;
        let base = scenario.settings.base.map_or(0, |_| MOCA_BASE_JOINTS);
        let calmness = CalmnessMonitor::new(&scenario.model, base, period);
        let torques = scenario.torques.clone();
        let plant =
            Plant::with_torques(scenario.drive, controller, torques, &scenario.robot, SEED)?;
        let mut run = Self {
            scorer: Scorer::new(&scenario.map),
            assessor: Assessor::new(scenario.posture),
            measured: None,
            plant,
            work: WorkForce::default(),
            encounter: Encounter::new(scenario),
            monitor,
            person: SeenPerson::default(),
            true_person: scenario.truth.as_ref().map(|motion| TruePerson::new(motion, period)),
            others: SeenOthers::default(),
            separation,
            calmness,
            period,
            engaged: Together::default(),
            state: SafetyState::Normal,
            tally: Tally::default(),
            recorder: None,
            scenario,
        };
        if let Delivery::Grasped = scenario.delivery {
            run.grasp(&scenario.object)?;
        }
        Ok(run)
    }

    /// Adds a recorder that sees every camera frame and every tick.
    #[must_use]
    pub fn recorded_by(mut self, recorder: &'a mut Recorder) -> Self {
        self.recorder = Some(recorder);
        self
    }

    /// Plays the scenario to its end. `each` sees every tick with the robot after it, and may end the run there.
    ///
    /// # Errors
    /// Percepts out of order.
    pub fn play(
        mut self,
        mut each: impl FnMut(&TickRow, &Plant) -> ControlFlow<()>,
    ) -> Result<Summary, Error> {
        let begin = self.scenario.percepts.first().map_or(0.0, |percept| percept.time);
        let duration = self.scenario.duration();
        let percepts = self.scenario.percepts.iter().zip(&self.scenario.arrivals);
        let mut percepts = percepts.enumerate().peekable();
        let started = Instant::now();
        let mut elapsed = 0.0;
        let mut flow = ControlFlow::Continue(());
        while elapsed <= duration && flow.is_continue() {
            let has_come = |(_, (_, at)): &(usize, (&Percept, &f64))| **at <= begin + elapsed;
            while let Some((frame, (percept, _))) = percepts.next_if(has_come) {
                let robot = RobotView::of(&self.plant);
                let shown = self.encounter.show(percept, &robot)?;
                let others = self.scenario.others(frame);
                self.observe(&shown, others)?;
                self.adapt()?;
                let person = percept.body.as_ref();
                self.others.update(percept.time, person, others);
                if let Some(body) = &shown.body {
                    self.person.update(percept.time, body);
                    if let Some(person) = &mut self.true_person {
                        person.show(percept.time, &self.encounter.hand);
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
            flow = each(&row, &self.plant);
            #[expect(clippy::cast_precision_loss, reason = "ticks count far below 2^52")]
            let time = self.tally.ticks as f64 * self.period;
            elapsed = time;
        }
        let wall = started.elapsed().as_secs_f64();
        let played = Played {
            is_complete: flow.is_continue(),
            duration: elapsed.min(duration),
            wall,
            period: self.period,
            margins: self.monitor.margins(),
            truth: self.true_person.is_some(),
            calmness: match &self.scenario.truth {
                Some(motion) => self.calmness.judge(|time| motion.at(begin + time)),
                None => Calmness::default(),
            },
        };
        Ok(self.tally.summary(&played))
    }

    fn observe(&mut self, percept: &Percept, others: &[Body]) -> Result<(), Error> {
        // Too many people or an impossible body stop the robot. The run goes on.
        match self.plant.observe(Scene::from(percept).with_others(others)) {
            Err(Error::Controller(
                moca_model::Error::Body { .. }
                | moca_model::Error::Safety(
                    hrsw_safety::Error::TooManyPeople { .. } | hrsw_safety::Error::BodySpeed { .. },
                ),
            )) => Ok(()),
            taken => taken,
        }
    }

    /// Closes the gripper when the object is there.
    fn close_gripper(&mut self) -> Result<(), Error> {
        match &self.scenario.delivery {
            Delivery::HandedOver { believed } if self.plant.command().phase == Phase::Grasping => {
                self.grasp(believed)
            }
            _ => Ok(()),
        }
    }

    /// Lets the robot grasp the object and believe it to be this one.
    fn grasp(&mut self, believed: &GraspedObject) -> Result<(), Error> {
        let tool = self.plant.controller().robot().tool();
        self.separation.carry(tool, rod(&self.scenario.object.capsule()?));
        self.plant.grasp(believed)
    }

    /// Adapts the ergonomics that the controller minimises to the measured stature.
    fn adapt(&mut self) -> Result<(), Error> {
        let Some(stature) = self.scenario.adapts_from else { return Ok(()) };
        if let Some(measured) = self.plant.controller().space().stature() {
            let ergonomics = self.scenario.ergonomics.resized(measured.stature / stature)?;
            self.plant.controller_mut().set_ergonomics(ergonomics);
        }
        Ok(())
    }

    fn tick(&mut self, now: f64) -> Result<TickRow, Error> {
        let tick_us = self.plant.step(now)?;
        let actual = self.plant.hand().translation.vector;
        let (command, situation) = (self.plant.command(), self.plant.controller().situation());
        let undisturbed = command.safety == SafetyState::Normal && situation.worker.is_none();
        let returning = if undisturbed { Return::Free } else { Return::Hindered };
        let breaches = self.monitor.check(command, self.plant.reference(), returning);

        let inside = Together::is_inside(self.plant.controller());
        let engaged = self.engaged.update(self.plant.controller());
        let mut row = tick_row(&self.plant, now, tick_us);
        row.collaborating = engaged;
        let hand = situation.worker.and_then(|person| {
            let floor = Vector3::new(person.floor.x, person.floor.y, 0.0);
            let frame = PersonFrame::new(floor, person.heading).ok()?;
            self.scorer.score(&frame, &actual)
        });
        // The tool relative to the person, if the frame that is held were at the person.
        let held = self.plant.controller().space().person_frame()?;
        let unheld = self.scorer.score(&held, &actual);
        if let Some(hand) = hand {
            row.score = hand.score;
            row.reba = hand.reba;
        }
        let begins = |state| command.safety == state && self.state != state;
        let stops = begins(SafetyState::ProtectiveStop);
        // Recovery from a stop goes through the same state.
        let cause = self.plant.controller().safety().supervisor().cause();
        let is_near = matches!(cause, Some(Cause::TooClose(_)));
        let retreats = begins(SafetyState::Retreat) && is_near;
        row.reba_measured = self.measured.map(|measured| measured.reba.reba);
        self.move_person(now, Some(actual).filter(|_| engaged));
        let too_near = self.is_too_near()?;
        let command = self.plant.command();
        self.calmness.watch(command, actual, engaged);
        let tally = &mut self.tally;
        tally.separation_violations += u64::from(too_near);
        if let (true, Some(reba)) = (engaged, row.reba_measured) {
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
        if let (true, Some(hand)) = (engaged, hand) {
            tally.together += 1;
            tally.score += hand.score;
            tally.score_of_hold += unheld.map_or(0.0, |unheld| hand.score - unheld.score);
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
        self.tally.ticks_us.push(tick_us);
        let towards =
            self.plant.controller().situation().worker.map(|person| {
                Vector3::new(actual.x - person.floor.x, actual.y - person.floor.y, 0.0)
            });
        let force = self.work.advance(towards.filter(|_| engaged), self.period);
        self.plant.act(&force)?;
        self.close_gripper()?;
        Ok(row)
    }

    /// Moves the person's hand with the object there \[m\], if they work on one.
    fn move_person(&mut self, now: f64, object: Option<Vector3<f64>>) {
        if let Some(joints) = self.scenario.truth.as_ref().and_then(|motion| motion.at(now)) {
            self.encounter.hand.follow(&joints);
        }
        self.encounter.advance(now, self.period, object);
        if let Some(person) = &mut self.true_person {
            person.advance(now, &self.encounter.hand);
        }
    }

    /// Returns true if the robot approaches a person more than allowed. The true person counts, or the person of the
    /// percepts if that is not known. Others count as they are seen.
    fn is_too_near(&mut self) -> Result<bool, Error> {
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
}
