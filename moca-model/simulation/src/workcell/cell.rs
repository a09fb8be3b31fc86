//! The loop, period by period.

use ergo_map::{ErgonomicsMap, PersonFrame};
use human_perception::percepts::{MeasuredAssessment, assess};
use moca_model::whole_body::FrameId;
use moca_model::{
    Controller, DynamicRobotSettings, Goal, GraspedObject, MOCA_HOME, Phase, Scene, moca,
};
use moca_replay::report::{TickRow, Together};
use nalgebra::{Isometry3, Point2, Point3, Vector2, Vector3};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use simulated_people::{Activity, Lead, LedPerson, Movement, Way, Workplace};
use vision_models::{Body, Confidence, Keypoint, Percept, Tool};

use super::eye::Eye;
use super::faults::Faults;
use super::guided::{Guided, joints};
use super::judge::{Counts, Judge};
use super::memory::{Memory, Remembered, TRUE_RATE};
use super::setup::Setup;
use crate::error::Error;
use crate::plant::{Heard, Plant};
use crate::run::{HandScore, OnBoardEye, RobotView, Scorer, WorkForce, tick_row};

/// Places where the people stand at first, in the world \[m\].
const PLACES: [Point2<f64>; 2] = [Point2::new(2.6, 0.0), Point2::new(1.5, 2.6)];
/// Place where the person stands to work at first \[m\].
const WORKPLACE: Point2<f64> = Point2::new(1.45, 0.0);
/// After so long without a measurement a loop halts the robot \[s\].
const BLIND: f64 = 0.1;
/// The link that an elbow is.
const ELBOW: &str = "panda_link4";
/// Offset from what a person works on to the robot's hand, in the tool's frame \[m\].
const BETWEEN: Vector3<f64> = Vector3::new(0.0, 0.0, -0.08);
/// The stream of movements on the spot.
const MOVEMENTS: u64 = 430;

/// A person who is led.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Who {
    /// The one who works with the robot.
    Worker,
    /// Somebody who only comes near.
    Bystander,
}

/// A robot, its controller and people, period by period. A clone goes on beside it.
#[derive(Clone, Debug)]
pub struct Workcell {
    setup: Setup,
    scorer: Scorer<ErgonomicsMap>,
    plant: Plant,
    elbow: FrameId,
    object: GraspedObject,
    worker: Guided,
    bystander: Option<Guided>,
    eye: Eye,
    on_board: OnBoardEye,
    work: WorkForce,
    judge: Judge,
    memory: Memory,
    movements: ChaCha8Rng,
    faults: Faults,
    /// Time without a measurement \[s\].
    blind: f64,
    /// Way that odometry has measured and the base has not gone \[m, world\].
    slipped: Vector2<f64>,
    engaged: Together,
    period: f64,
    tick: u64,
    row: TickRow,
}

impl Workcell {
    /// The robot at home, and the person before it.
    ///
    /// # Errors
    /// Settings that the controller refuses.
    pub fn new(setup: Setup) -> Result<Self, Error> {
        let (model, settings) = (moca()?, setup.robot.controller.clone());
        let (period, stature, seed) = (settings.period, setup.map.stature(), setup.seed);
        let judge = Judge::new(&model, &settings, &MOCA_HOME)?;
        let controller = Controller::new(model.clone(), setup.ergonomics, settings, &MOCA_HOME)?;
        let torques = setup.robot.torques.clone();
        let plant = Plant::with_torques(
            setup.robot.drive,
            controller,
            torques,
            &DynamicRobotSettings::default(),
            seed,
        )?;
        let mut cell = Self {
            scorer: Scorer::new(setup.map.clone()),
            elbow: model.frame_id(ELBOW)?,
            object: GraspedObject::default(),
            worker: Guided::new(stature, PLACES[0])?,
            bystander: None,
            eye: Eye::new(seed, period),
            on_board: OnBoardEye::new(seed),
            work: WorkForce::default(),
            judge,
            memory: Memory::new(stature),
            movements: simulated_people::generator(seed, MOVEMENTS),
            faults: Faults::default(),
            blind: 0.0,
            slipped: Vector2::zeros(),
            engaged: Together::default(),
            period,
            tick: 0,
            row: tick_row(&plant, 0.0, 0.0),
            plant,
            setup,
        };
        if !cell.setup.hands_over {
            cell.grasp()?;
        }
        Ok(cell)
    }

    /// The person comes to work with the drill, or brings the object if the robot does not hold it.
    ///
    /// # Errors
    /// None.
    pub fn welcome(&mut self) -> Result<(), Error> {
        let way = Way::To(WORKPLACE);
        let brings = self.setup.hands_over;
        let activity = if brings { Activity::CarryObject } else { Activity::Use(Tool::Drill) };
        self.lead(Who::Worker, Lead { way, activity, ..Lead::default() })
    }

    /// Somebody does this from now on.
    ///
    /// # Errors
    /// What nobody can do; nothing changes then. Nobody is led who is not there.
    pub fn lead(&mut self, who: Who, lead: Lead) -> Result<(), Error> {
        self.guided(who)?.lead(lead)
    }

    /// Somebody begins a movement on the spot as soon as they stand.
    ///
    /// # Errors
    /// Nobody moves who is not there.
    pub fn begin(&mut self, who: Who, movement: Movement) -> Result<(), Error> {
        let draw = simulated_people::generator(self.movements.random(), MOVEMENTS);
        self.guided(who)?.person.begin(movement, draw);
        Ok(())
    }

    fn guided(&mut self, who: Who) -> Result<&mut Guided, Error> {
        let absent = || Error::Unfit {
            found: "the second person is not there".to_owned(),
            wanted: "let them come first",
        };
        match who {
            Who::Worker => Ok(&mut self.worker),
            Who::Bystander => self.bystander.as_mut().ok_or_else(absent),
        }
    }

    /// The second person comes, or leaves.
    ///
    /// # Errors
    /// None.
    pub fn set_bystander(&mut self, is_there: bool) -> Result<(), Error> {
        if !is_there {
            self.bystander = None;
        } else if self.bystander.is_none() {
            self.bystander = Some(Guided::new(self.setup.map.stature(), PLACES[1])?);
        }
        Ok(())
    }

    /// Sets what goes wrong from now on.
    ///
    /// # Errors
    /// Faults out of range; nothing changes then.
    pub fn set_faults(&mut self, faults: Faults) -> Result<(), Error> {
        faults.validate()?;
        self.eye.set(&faults);
        if faults.payload != self.faults.payload {
            self.plant.load(faults.payload)?;
        }
        let tool = self.plant.controller().robot().tool();
        self.plant.push(&[(tool, faults.push_tool), (self.elbow, faults.push_elbow)]);
        self.faults = faults;
        Ok(())
    }

    /// Things that go wrong.
    pub fn faults(&self) -> &Faults {
        &self.faults
    }

    /// Asks for ergonomics from now on, or for no more than the least motion.
    pub fn set_goal(&mut self, goal: Goal) {
        self.plant.controller_mut().set_goal(goal);
        self.setup.robot.controller.goal = goal;
    }

    /// Somebody has seen to the robot, which goes on.
    pub fn acknowledge(&mut self) {
        self.plant.controller_mut().safety_mut().supervisor_mut().acknowledge();
        self.plant.recover();
    }

    /// Asks the robot to stop.
    pub fn request_stop(&mut self) {
        self.plant.controller_mut().request_stop();
    }

    /// Robot, controller and people go on by a period.
    ///
    /// # Errors
    /// What the controller refuses, but for frames, which it reports as faults.
    pub fn advance(&mut self) -> Result<(), Error> {
        let now = self.time();
        let workplace = self.workplace();
        for person in std::iter::once(&mut self.worker).chain(&mut self.bystander) {
            person.advance(self.period, &workplace, &self.judge);
        }
        self.remember(now);
        let bystander = self.bystander.as_ref().map(|guided| guided.person.person());
        self.eye.look((self.tick, now), self.worker.person.person(), bystander, &self.faults);
        while let Some((percept, others)) = self.eye.arrived(now) {
            self.observe(percept, others, now)?;
        }
        self.control(now)?;
        let towards = self.plant.controller().situation().worker.map(|person| {
            let hand = Vector3::from(self.row.actual);
            Vector3::new(hand.x - person.floor.x, hand.y - person.floor.y, 0.0)
        });
        let force = self.work.advance(towards.filter(|_| self.row.collaborating), self.period);
        let before = floor(&self.plant);
        self.plant.act(&force)?;
        let slip = self.faults.slip;
        self.slipped += (floor(&self.plant) - before) * (slip / (1.0 - slip));
        if self.plant.command().phase == Phase::Grasping
            && self.plant.controller().object().is_none()
        {
            self.grasp()?;
        }
        self.tick += 1;
        Ok(())
    }

    /// The time of the next tick \[s\].
    pub fn time(&self) -> f64 {
        self.tick as f64 * self.period
    }

    /// Number of periods that have passed.
    pub fn tick(&self) -> u64 {
        self.tick
    }

    /// Time between two ticks \[s\].
    pub fn period(&self) -> f64 {
        self.period
    }

    fn workplace(&self) -> Workplace {
        let tool = self.plant.tool();
        let object = Point3::from(self.plant.hand().translation.vector);
        Workplace { object, between: tool * Point3::from(BETWEEN) }
    }

    fn remember(&mut self, now: f64) {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at least 1")]
        let every = (1.0 / (TRUE_RATE * self.period)).round().max(1.0) as u64;
        if self.tick.is_multiple_of(every) {
            self.memory.witness(now, &self.worker.person.person().joints());
        }
    }

    fn observe(&mut self, percept: Percept, others: Vec<Body>, now: f64) -> Result<(), Error> {
        let surface = self.on_board.look(&RobotView::of(&self.plant), &self.object)?;
        let percept = Percept { surface, ..percept };
        let taken = self.plant.observe(Scene::from(&percept).with_others(&others));
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a tick")]
        let tick = (percept.time / self.period).round() as usize;
        match taken {
            Ok(()) => {
                let error = Isometry3::identity();
                if percept.body.is_some() {
                    self.worker.witness.show(tick, &error);
                }
                if let Some(bystander) = self.bystander.as_mut().filter(|_| !others.is_empty()) {
                    bystander.witness.show(tick, &error);
                }
            }
            // Frames that count as no data, and too many people, are faults, which the supervisor knows.
            Err(Error::Controller(
                moca_model::Error::Frame { .. }
                | moca_model::Error::Body { .. }
                | moca_model::Error::Safety(
                    hrsw_safety::Error::TooManyPeople { .. } | hrsw_safety::Error::BodySpeed { .. },
                ),
            )) => {}
            Err(error) => return Err(error),
        }
        self.memory.see(Remembered { percept, others, arrived: now });
        Ok(())
    }

    fn control(&mut self, now: f64) -> Result<(), Error> {
        self.blind = if self.faults.measurements { self.blind + self.period } else { 0.0 };
        let is_cut = self.faults.cable || self.blind > BLIND;
        let loss = if is_cut { 1.0 } else { DynamicRobotSettings::default().loss };
        self.plant.lose_commands(loss)?;
        let heard = if self.faults.measurements { Heard::Nothing } else { Heard::Measurement };
        let slipped = self.slipped;
        let tick_us = self.plant.step_measuring(now, heard, |measured| {
            measured.iter_mut().zip(&slipped).for_each(|(place, slipped)| *place += slipped);
        })?;
        self.row = tick_row(&self.plant, now, tick_us);
        self.row.collaborating = self.engaged.update(self.plant.controller());
        let contact = self.plant.controller().safety().contact_speed() > 0.0;
        let worker = self.worker.witness.moment(contact);
        let bystander = self.bystander.as_ref().and_then(|guided| guided.witness.moment(false));
        let people: Vec<_> = worker.into_iter().chain(bystander).collect();
        self.judge.check(&self.plant, &people, self.faults.disturb_the_robot())
    }

    /// The robot holds the object from now on.
    fn grasp(&mut self) -> Result<(), Error> {
        let tool = self.plant.controller().robot().tool();
        self.judge.carry(tool, &self.object.capsule()?);
        self.plant.grasp(&self.object)
    }

    /// The last tick of the controller.
    pub fn row(&self) -> &TickRow {
        &self.row
    }

    /// The score of the person with the hand at what the robot holds; none unless they work together.
    pub fn score(&self) -> Option<HandScore> {
        let person =
            self.plant.controller().situation().worker.filter(|_| self.row.collaborating)?;
        let floor = Vector3::new(person.floor.x, person.floor.y, 0.0);
        let frame = PersonFrame::new(floor, person.heading).ok()?;
        self.scorer.score(&frame, &self.row.actual.into())
    }

    /// REBA of a person's true posture.
    ///
    /// # Errors
    /// None for a body whose joints are finite.
    pub fn true_posture(&self, who: Who) -> Result<Option<MeasuredAssessment>, Error> {
        let Some(body) = self.body(who) else { return Ok(None) };
        Ok(assess(&body)?)
    }

    /// The true joints of a person as a body; none who is not there.
    pub fn body(&self, who: Who) -> Option<Body> {
        let seen = |position| Some(Keypoint { position, confidence: Confidence::ONE });
        self.person(who).map(|person| Body::new(joints(person).map(seen)))
    }

    /// A person; none who is not there.
    pub fn person(&self, who: Who) -> Option<&LedPerson> {
        match who {
            Who::Worker => Some(&self.worker.person),
            Who::Bystander => self.bystander.as_ref().map(|guided| &guided.person),
        }
    }

    /// The robot with its controller.
    pub fn plant(&self) -> &Plant {
        &self.plant
    }

    /// Object that the robot holds, or will.
    pub fn object(&self) -> &GraspedObject {
        &self.object
    }

    /// The setup that it began with, and the goal of now.
    pub fn setup(&self) -> &Setup {
        &self.setup
    }

    /// Counts of the judges.
    pub fn counts(&self) -> &Counts {
        &self.judge.counts
    }

    /// Memory of what the robot saw, and where the person was.
    pub fn memory(&self) -> &Memory {
        &self.memory
    }
}

/// The true place of the base \[m, world\].
fn floor(plant: &Plant) -> Vector2<f64> {
    match plant.configuration() {
        [x, y, ..] => Vector2::new(*x, *y),
        _ => Vector2::zeros(),
    }
}
