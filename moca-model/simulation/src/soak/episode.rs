//! One robot, one controller, a person and passers-by, for some seconds.

use ergo_map::ErgonomicsQuadratic;
use hrsw_safety::{FORGET_AFTER, LEAST_CONFIDENCE, SafetyState};
use moca_model::whole_body::Model;
use moca_model::{
    Controller, ControllerSettings, DynamicRobotSettings, Goal, GraspedObject, MOCA_HOME, Scene,
};
use moca_replay::report::Together;
use nalgebra::{Matrix3, Vector2, Vector3};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use simulated_people::{
    CameraSettings, CapturedMotion, FRAME_RATE, Movement, Perception, Transport, Wanderer,
};
use vision_models::{Body, Percept, PersonId, Tool};

use super::disturbance::{Disturbance, Disturbances};
use super::monitor::{Monitor, Tick};
use super::task::Task;
use super::witnessed::Witnessed;
use crate::error::Error;
use crate::judges::{StillnessMonitor, body};
use crate::plant::{Plant, PlantSettings};

/// Purpose of a generator.
#[derive(Clone, Copy)]
enum Stream {
    Start,
    Person,
    Camera,
    Recogniser,
    Transport,
    Task,
    Disturbances,
    PassersBy,
    Motions = 100,
}

/// No joint is seen farther than this from where it is \[m\]: well within Z_d, the uncertainty
/// that the protective distance allows for.
const LARGEST_ERROR: f64 = 0.02;

/// Share of the people who have the motion of a real one.
const REAL: f64 = 0.3;

/// Time from the end of a disturbance to its acknowledgement \[s\].
const ACKNOWLEDGED: f64 = 0.5;

/// The greatest probability that a joint is missing in a frame.
const DROP: f64 = 0.1;

/// Largest number of people who walk by; streams of random numbers of each.
const PASSERS_BY: u64 = 2;
const STREAMS: u64 = 3;

fn generator(seed: u64, stream: Stream) -> ChaCha8Rng {
    simulated_people::generator(seed, stream as u64)
}

/// The closed loop.
#[derive(Debug)]
pub(super) struct Episode {
    plant: Plant,
    pub(super) monitor: Monitor,
    pub(super) stillness: StillnessMonitor,
    together: Together,
    person: Witnessed,
    perception: Perception,
    passers_by: Vec<Witnessed>,
    /// The camera, for each of them.
    cameras: Vec<Perception>,
    transport: Transport,
    task: Task,
    disturbances: Disturbances,
    /// True if the workspace changes at random.
    has_tasks: bool,
    /// When the last disturbance ended, the time of the tick before \[s\].
    ended: f64,
    last: f64,
    tick: usize,
    /// Ticks from a camera frame to the next.
    frame: usize,
    period: f64,
    /// True if a frame has shown all of the person since the robot last forgot who it had seen.
    seen_whole: bool,
}

impl Episode {
    /// The episode of this seed.
    pub(super) fn new(model: &Model, seed: u64, robot: &PlantSettings) -> Result<Self, Error> {
        let draws = |streams: [Stream; 2]| streams.map(|stream| generator(seed, stream));
        let mut draw = generator(seed, Stream::Start);
        let start = start(model, &mut draw);
        let goal = if draw.random_bool(0.8) { Goal::Ergonomics } else { Goal::LeastMotion };
        let PlantSettings { drive, controller, torques } = robot.clone();
        let object = GraspedObject::default();
        let settings = ControllerSettings { goal, ..controller };
        let robot = Vector2::new(start[0], start[1]);
        let camera = CameraSettings {
            largest_error: LARGEST_ERROR,
            drop: draw.random_range(0.0..DROP),
            lasting: draw.random_range(0.0..=CameraSettings::LASTING),
            ..CameraSettings::default()
        };
        let eyes = draws([Stream::Camera, Stream::Recogniser]);
        let mut draw = generator(seed, Stream::PassersBy);
        let (mut passers_by, mut cameras) = (Vec::new(), Vec::new());
        let mut motions = generator(seed, Stream::Motions);
        let largest = settings.safety.separation.human_speed;
        let mut somebody = |wanderer| -> Result<Witnessed, Error> {
            let person = Witnessed::new(wanderer);
            let name = CapturedMotion::NAMES[motions.random_range(0..CapturedMotion::NAMES.len())];
            if !motions.random_bool(REAL) {
                return Ok(person);
            }
            Ok(person.performing(CapturedMotion::named(name)?, largest))
        };
        for number in 0..draw.random_range(0..=PASSERS_BY) {
            let streams = |index| {
                let stream = Stream::PassersBy as u64 + 1 + number * STREAMS + index;
                simulated_people::generator(seed, stream)
            };
            passers_by.push(somebody(Wanderer::passing_by(streams(0), robot))?);
            let camera = CameraSettings { drop: 0.0, ..camera };
            let eyes = [streams(1), streams(2)];
            let id = PersonId::new(1 + number);
            cameras.push(Perception::new(id, camera, 0.0, Tool::Drill, eyes));
        }
        let person = somebody(Wanderer::new(generator(seed, Stream::Person), robot))?;
        let period = settings.period;
        let mut monitor = Monitor::new(model, &settings, &start)?;
        let controller = Controller::new(model.clone(), ergonomics()?, settings, &start)?;
        monitor.carry(controller.robot().tool(), &object.capsule()?);
        let mut plant = Plant::with_torques(
            drive,
            controller,
            torques,
            &DynamicRobotSettings::default(),
            seed,
        )?;
        plant.grasp(&object)?;
        Ok(Self {
            monitor,
            stillness: StillnessMonitor::new(period),
            together: Together::default(),
            person,
            perception: Perception::new(PersonId::new(0), camera, 0.0, Tool::Drill, eyes),
            passers_by,
            cameras,
            transport: Transport::new(generator(seed, Stream::Transport)),
            task: Task::new(generator(seed, Stream::Task)),
            disturbances: Disturbances::new(generator(seed, Stream::Disturbances), drive),
            has_tasks: true,
            ended: 0.0,
            last: 0.0,
            frame: ticks(1.0 / FRAME_RATE, period),
            period,
            plant,
            tick: 0,
            seen_whole: false,
        })
    }

    /// Creates the episode of this seed in which a person near the tool repeats a movement, without disturbances. Also
    /// returns whether the person works with the robot.
    pub(super) fn repeating(
        model: &Model,
        seed: u64,
        (movement, together): (Movement, bool),
        robot: &PlantSettings,
    ) -> Result<Self, Error> {
        let mut episode = Self::new(model, seed, robot)?;
        let tool = episode.plant.hand().translation.vector.xy();
        let configuration = episode.plant.configuration();
        let outwards = tool - Vector2::new(configuration[0], configuration[1]);
        let draw = generator(seed, Stream::Person);
        let place = (tool.into(), outwards);
        episode.person = Witnessed::new(Wanderer::repeating(draw, movement, place, together));
        episode.passers_by.clear();
        episode.cameras.clear();
        episode.has_tasks = false;
        episode.disturbances =
            Disturbances::none(generator(seed, Stream::Disturbances), robot.drive);
        Ok(episode)
    }

    /// Runs one period. Returns the time that the controller took \[µs\], if it ran.
    pub(super) fn step(&mut self) -> Result<Option<f64>, Error> {
        #[expect(clippy::cast_precision_loss, reason = "an episode lasts seconds")]
        let now = self.tick as f64 * self.period;
        // What a person works on, where their hand is then.
        let hand = self.plant.hand();
        let object = hand.translation.vector.into();
        let largest = self.plant.controller().settings().safety.separation.human_speed;
        for person in self.passers_by.iter_mut().chain([&mut self.person]) {
            person.advance((now, self.period), &object, largest)?;
        }
        self.advance_disturbances(now)?;
        self.look(now);
        while let Some((percept, others)) = self.transport.arrived(now) {
            self.receive(percept, &others, now)?;
        }
        if self.has_tasks {
            self.task.advance(now, self.plant.controller_mut().space_mut(), &hand)?;
        }
        let disturbance = self.disturbances.present(now);
        let is_late = matches!(disturbance, Some((Disturbance::TicksLate, _)));
        let tick_us = if is_late && self.tick % 10 < 4 {
            self.monitor.miss();
            None
        } else {
            Some(self.control(now)?)
        };
        if self.plant.command().joint_velocity.iter().all(|velocity| velocity.is_finite()) {
            self.plant.act(&self.disturbances.push(now))?;
        }
        self.tick += 1;
        Ok(tick_us)
    }

    /// A tick of the controller, and what is to be said of it; how long it took (µs).
    fn control(&mut self, now: f64) -> Result<f64, Error> {
        let time = self.disturbances.time(now, self.last);
        let disturbance = self.disturbances.present(now);
        let is_nan = matches!(disturbance, Some((Disturbance::MeasurementNan, _)));
        let tick_us = self.plant.step_measuring(time, self.disturbances.heard(), |position| {
            if is_nan {
                position[4] = f64::NAN;
            }
        })?;
        if !time.is_nan() {
            self.last = time;
        }
        self.watch_stillness(disturbance.is_none());
        let contact = self.plant.controller().safety().contact_speed() > 0.0;
        let passers_by = self.passers_by.iter().map(|person| person.moment(false));
        let people = passers_by.chain([self.person.moment(contact)]);
        let people: Vec<_> = people.flatten().collect();
        self.monitor.check(&Tick {
            command: self.plant.command(),
            configuration: self.plant.configuration(),
            reference: self.plant.reference(),
            breaks_torque: self.plant.breaks_torque_limits(),
            people: &people,
            disturbance,
        })?;
        Ok(tick_us)
    }

    /// Tells the monitor of stillness of this tick, which counts only without a disturbance and a stop.
    fn watch_stillness(&mut self, undisturbed: bool) {
        let together = self.together.update(self.plant.controller())
            && self.plant.command().safety == SafetyState::Normal;
        let base = match self.plant.command().joint_velocity.as_slice() {
            [x, y, ..] => Vector2::new(*x, *y),
            _ => Vector2::zeros(),
        };
        let (person, hand) = (self.person.person.person().joints(), self.plant.hand());
        let workpiece = hand.translation.vector;
        self.stillness.watch(&person, workpiece, base, together && undisturbed);
    }

    /// Begins and ends disturbances; some time after one somebody acknowledges what it has left.
    fn advance_disturbances(&mut self, now: f64) -> Result<(), Error> {
        let state = self.plant.command().safety;
        if let Some(ended) = self.disturbances.advance(now) {
            self.monitor.ended.count(ended, state);
            // The robot forgets people who were seen at wrong times. The person who acknowledges looks for people.
            if ended.is_of_time() {
                self.passers_by.iter_mut().chain([&mut self.person]).for_each(Witnessed::forget);
                self.seen_whole = false;
            }
            self.ended = now;
        }
        self.plant.lose_commands(self.disturbances.loss(now))?;
        let supervisor = self.plant.controller_mut().safety_mut().supervisor_mut();
        let is_over = self.disturbances.present(now).is_none() && now > self.ended + ACKNOWLEDGED;
        if is_over && supervisor.waits_for_acknowledgement() {
            supervisor.acknowledge();
            self.plant.recover();
        }
        Ok(())
    }

    /// Gives the controller a frame with passers-by, or what has become of it.
    fn receive(&mut self, percept: Percept, others: &[Body], now: f64) -> Result<(), Error> {
        let disturbance = self.disturbances.present(now);
        let is_seen = percept.body.is_some()
            && !disturbance.is_some_and(|(disturbance, _)| disturbance.hides_the_person());
        let (time, tick) = (percept.time, ticks(percept.time, self.period));
        let error = self.disturbances.camera_error().copied().unwrap_or_default();
        if is_seen {
            self.person.show(tick, &error);
        }
        let others: Vec<_> = others.iter().map(|body| body.transformed(&error)).collect();
        for frame in self.disturbances.frames(percept) {
            let others = if frame.time == time { &others[..] } else { &[] };
            let taken = self.plant.observe(Scene::from(&frame).with_others(others));
            if taken.is_ok() && !others.is_empty() {
                self.passers_by.iter_mut().for_each(|person| person.show(tick, &error));
            }
            // The loop goes on without the frames that the controller refuses.
            let jumped = matches!(
                taken,
                // A camera that is turned moves everybody at once.
                Err(Error::Controller(moca_model::Error::Safety(
                    hrsw_safety::Error::BodySpeed { .. }
                )))
            );
            if disturbance.is_none() && now > self.ended + ACKNOWLEDGED && !jumped {
                taken?;
            }
        }
        Ok(())
    }

    /// Takes a camera frame if one is due.
    fn look(&mut self, now: f64) {
        if !self.tick.is_multiple_of(self.frame) {
            return;
        }
        if self.person.unseen_for().is_some_and(|unseen| unseen >= ticks(FORGET_AFTER, self.period))
        {
            // The person who comes back may be somebody else.
            self.seen_whole = false;
        }
        let others = self.passers_by.iter().zip(&mut self.cameras);
        let seen = others.filter_map(|(other, camera)| {
            camera.look(now, other.person.person(), true).and_then(|percept| percept.body)
        });
        let others = seen.collect();
        let person = &self.person.person;
        let mut percept = self.perception.look(now, person.person(), person.is_in_view());
        if let Some(percept) = &mut percept {
            // The robot cannot keep its distance from a part that it has never seen.
            self.seen_whole |= percept.body.as_ref().is_some_and(|body| {
                body::joints().all(|joint| {
                    body.get(joint).is_some_and(|seen| seen.confidence.value() >= LEAST_CONFIDENCE)
                })
            });
            percept.body = percept.body.take().filter(|_| self.seen_whole);
        }
        let frame = percept.map(|percept| (percept, others));
        self.transport.send(frame, self.disturbances.delay());
    }

    /// The first tick with something wrong.
    pub(super) fn first_wrong(&mut self) -> Option<String> {
        let what = self.monitor.first_wrong.take()?;
        self.monitor.first_wrong = Some(String::new());
        let (time, safety) = (self.tick, self.plant.controller().safety());
        (!what.is_empty()).then(|| {
            let person = safety.person_bodies().first();
            format!(
                "tick {time} of the episode: {what}; {:?}; nearest {:?}; person {:?}",
                safety.supervisor().state(),
                safety.nearest(),
                person.map(|body| body.velocity),
            )
        })
    }

    /// Returns true if the robot moves.
    pub(super) fn moves(&self) -> bool {
        self.plant
            .controller()
            .command()
            .joint_velocity
            .iter()
            .any(|velocity| velocity.abs() > 1e-3)
    }
}

/// Number of periods in a time \[s\].
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "times are not negative, and an episode lasts seconds"
)]
fn ticks(time: f64, period: f64) -> usize {
    (time / period).round() as usize
}

/// The home configuration, somewhere, and a little different; in some episodes outside the range
/// of a joint.
fn start(model: &Model, draw: &mut ChaCha8Rng) -> Vec<f64> {
    let mut start = MOCA_HOME.to_vec();
    for q in &mut start[..2] {
        *q = draw.random_range(-3.0..3.0);
    }
    start[2] = draw.random_range(-6.0..6.0);
    for q in &mut start[3..] {
        *q += draw.random_range(-0.2..0.2);
    }
    if draw.random_bool(0.4) {
        let limits = model.limits();
        let beyond = draw.random_range(0.001..0.2);
        // Joints that collide with nothing there.
        match draw.random_range(0..4) {
            0 => start[3] = limits[3].lower - beyond,
            1 => start[6] = limits[6].upper + beyond,
            2 => start[8] = limits[8].lower - beyond,
            _ => start[9] = limits[9].upper + beyond,
        }
    }
    start
}

/// Best with the hand before the person at the height of the elbow.
fn ergonomics() -> Result<ErgonomicsQuadratic, Error> {
    let hessian = Matrix3::from_diagonal(&Vector3::new(10.0, 5.0, 7.0));
    let best = Vector3::new(0.4, -0.1, 1.1);
    let least = 0.5 * best.dot(&(hessian * best));
    Ok(ErgonomicsQuadratic::new(hessian, -(hessian * best), least)?)
}
