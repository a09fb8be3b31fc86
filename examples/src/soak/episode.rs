//! One robot, one person, one controller, for some seconds.

use anyhow::ensure;
use ergo_map::ErgonomicsQuadratic;
use moca_model::whole_body::Model;
use moca_model::{Controller, ControllerSettings, Goal, MOCA_HOME, SpaceSettings};
use nalgebra::{Matrix3, Vector2, Vector3};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use vision_models::{Percept, Tool};

use super::disturbance::{Disturbance, Disturbances};
use super::monitor::{Monitor, Tick};
use super::task::{POSITION_ROWS, Task};
use crate::plant::{Drive, Plant};
use crate::random;
use crate::separation::{Moment, body};
use crate::settings::RobotSettings;
use crate::simulation::{CameraSettings, FRAME_RATE, Joints, Perception, Transport, Wanderer};

/// What a generator is for.
#[derive(Clone, Copy)]
enum Stream {
    Start,
    Person,
    Camera,
    Recogniser,
    Transport,
    Task,
    Disturbances,
}

/// No joint is seen farther than this from where it is \[m\]: well within Z_d, the uncertainty
/// that the protective distance allows for.
const LARGEST_ERROR: f64 = 0.02;

/// From the end of a disturbance to its acknowledgement \[s\].
const ACKNOWLEDGED: f64 = 0.5;

/// The greatest probability that a joint is missing in a frame.
const DROP: f64 = 0.1;

fn generator(seed: u64, stream: Stream) -> ChaCha8Rng {
    random::generator(seed, stream as u64)
}

/// The closed loop.
#[derive(Debug)]
pub(super) struct Episode {
    plant: Plant,
    pub(super) monitor: Monitor,
    person: Wanderer,
    perception: Perception,
    transport: Transport,
    task: Task,
    disturbances: Disturbances,
    /// When the last disturbance ended, the time of the tick before \[s\].
    ended: f64,
    last: f64,
    tick: u64,
    /// Ticks from a camera frame to the next.
    frame: u64,
    period: f64,
    /// The person's joints at every tick; whether they jumped there.
    history: Vec<(Joints, bool)>,
    /// The tick at which the newest frame was taken that shows the person and has arrived.
    known: Option<usize>,
    /// Whether a frame has shown all of the person since the robot last forgot who it had seen.
    seen_whole: bool,
}

impl Episode {
    /// The episode of this seed.
    pub(super) fn new(
        model: &Model,
        seed: u64,
        drive: Drive,
        robot: &RobotSettings,
    ) -> anyhow::Result<Self> {
        let draws = |streams: [Stream; 2]| streams.map(|stream| generator(seed, stream));
        let mut draw = generator(seed, Stream::Start);
        let start = start(model, &mut draw);
        let goal = if draw.random_bool(0.8) { Goal::Ergonomics } else { Goal::LeastMotion };
        let RobotSettings { controller, torque } = robot.clone();
        let position_rows = controller.space.position_rows.max(POSITION_ROWS);
        let space = SpaceSettings { position_rows, ..controller.space };
        let settings = ControllerSettings { goal, space, ..controller };
        let robot = Vector2::new(start[0], start[1]);
        let camera = CameraSettings {
            largest_error: LARGEST_ERROR,
            drop: draw.random_range(0.0..DROP),
            ..CameraSettings::default()
        };
        let eyes = draws([Stream::Camera, Stream::Recogniser]);
        Ok(Self {
            monitor: Monitor::new(model, &settings, &start)?,
            person: Wanderer::new(generator(seed, Stream::Person), robot),
            perception: Perception::new(camera, 0.0, Tool::Drill, eyes),
            transport: Transport::new(generator(seed, Stream::Transport)),
            task: Task::new(generator(seed, Stream::Task)),
            disturbances: Disturbances::new(generator(seed, Stream::Disturbances), drive),
            ended: 0.0,
            last: 0.0,
            frame: ticks(1.0 / FRAME_RATE, settings.period),
            period: settings.period,
            plant: Plant::with_torques(
                drive,
                Controller::new(model.clone(), comfort()?, settings, &start)?,
                torque,
                seed,
            )?,
            tick: 0,
            history: Vec::new(),
            known: None,
            seen_whole: false,
        })
    }

    /// One period; how long the controller took (µs), if it had its turn.
    pub(super) fn step(&mut self) -> anyhow::Result<Option<f64>> {
        #[expect(clippy::cast_precision_loss, reason = "an episode lasts seconds")]
        let now = self.tick as f64 * self.period;
        let tool = self.plant.controller().actual();
        self.person.advance(now, self.period, tool.translation.vector.xy());
        self.history.push((self.person.person().joints(), self.person.jumped()));
        self.check_person()?;
        self.advance_disturbances(now);
        self.look(now);
        while let Some(percept) = self.transport.arrived(now) {
            self.receive(percept, now)?;
        }
        self.task.advance(now, self.plant.controller_mut().space_mut(), &tool)?;
        let disturbance = self.disturbances.present(now);
        let is_late = matches!(disturbance, Some((Disturbance::TicksLate, _)));
        let tick_us = if is_late && self.tick % 10 < 4 { None } else { Some(self.control(now)?) };
        if self.plant.command().joint_velocity.iter().all(|velocity| velocity.is_finite()) {
            self.plant.act(&self.disturbances.push(now))?;
        }
        self.tick += 1;
        Ok(tick_us)
    }

    /// A tick of the controller, and what is to be said of it; how long it took (µs).
    fn control(&mut self, now: f64) -> anyhow::Result<f64> {
        let time = self.disturbances.time(now, self.last);
        let disturbance = self.disturbances.present(now);
        let is_nan = matches!(disturbance, Some((Disturbance::MeasurementNan, _)));
        let tick_us = self.plant.step_measuring(time, |position| {
            if is_nan {
                position[4] = f64::NAN;
            }
        })?;
        if !time.is_nan() {
            self.last = time;
        }
        self.monitor.check(&Tick {
            command: self.plant.command(),
            configuration: self.plant.configuration(),
            reference: self.plant.reference(),
            breaks_torque: self.plant.breaks_torque_limits(),
            moment: Moment {
                person: body_at(&self.history, self.history.len() - 1),
                known: self.known.map(|tick| body_at(&self.history, tick)),
                contact: self.plant.controller().safety().contact_speed() > 0.0,
            },
            disturbance,
        })?;
        Ok(tick_us)
    }

    /// Begins and ends disturbances; some time after one somebody acknowledges what it has left.
    fn advance_disturbances(&mut self, now: f64) {
        let state = self.plant.command().safety;
        if let Some(ended) = self.disturbances.advance(now) {
            self.monitor.ended.count(ended, state);
            // The robot forgets what was seen at wrong times; who acknowledges looks for people.
            if ended.is_of_time() {
                (self.known, self.seen_whole) = (None, false);
            }
            self.ended = now;
        }
        let supervisor = self.plant.controller_mut().safety_mut().supervisor_mut();
        let is_over = self.disturbances.present(now).is_none() && now > self.ended + ACKNOWLEDGED;
        if is_over && supervisor.waits_for_acknowledgement() {
            supervisor.acknowledge();
        }
    }

    /// Gives the controller a frame, or what has become of it.
    fn receive(&mut self, percept: Percept, now: f64) -> anyhow::Result<()> {
        let disturbance = self.disturbances.present(now);
        let is_seen = percept.body.is_some()
            && !disturbance.is_some_and(|(disturbance, _)| disturbance.hides_the_person());
        if is_seen {
            self.known = Some(usize::try_from(ticks(percept.time, self.period))?);
        }
        for frame in self.disturbances.frames(percept) {
            let taken = self.plant.observe(&frame);
            // The loop goes on without the frames that the controller refuses.
            if disturbance.is_none() && now > self.ended + ACKNOWLEDGED {
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
        let forget_after = self.plant.controller().settings().safety.person.forget_after;
        let unseen_for = self.known.map(|tick| self.history.len() - tick);
        if unseen_for.is_some_and(|unseen| unseen as u64 >= ticks(forget_after, self.period)) {
            // Who comes back may be somebody else.
            self.seen_whole = false;
        }
        let person = &self.person;
        let mut percept = self.perception.look(now, person.person(), person.is_in_view());
        if let Some(percept) = &mut percept {
            // The robot cannot keep its distance from a part that it has never seen.
            let least = self.plant.controller().settings().safety.person.least_confidence;
            self.seen_whole |= percept.body.as_ref().is_some_and(|body| {
                body::joints().all(|joint| {
                    body.get(joint).is_some_and(|seen| seen.confidence.value() >= least)
                })
            });
            percept.body = percept.body.take().filter(|_| self.seen_whole);
        }
        self.transport.send(percept, self.disturbances.delay());
    }

    /// People keep to the speed that the robot assumes where it measures none; who does not
    /// would make the soak mean nothing.
    fn check_person(&self) -> anyhow::Result<()> {
        let (now, before) = body_at(&self.history, self.history.len() - 1);
        let Some(before) = before else { return Ok(()) };
        let largest = self.plant.controller().settings().safety.separation.human_speed;
        let ends = |joints| body::capsules(joints).into_iter().flat_map(|rod| rod.ends);
        let speeds = ends(now).zip(ends(before)).map(|(to, from)| (to - from).norm() / self.period);
        let fastest = speeds.fold(0.0, f64::max);
        ensure!(
            fastest <= largest,
            "a simulated person's part moves at {fastest} m/s, above the {largest} m/s assumed"
        );
        Ok(())
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

/// How many periods a time is \[s\].
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "times are not negative, and an episode lasts seconds"
)]
fn ticks(time: f64, period: f64) -> u64 {
    (time / period).round() as u64
}

/// The joints at a tick and at the one before, unless the person jumped between them.
fn body_at(history: &[(Joints, bool)], tick: usize) -> (&Joints, Option<&Joints>) {
    let (joints, jumped) = &history[tick];
    let before = tick.checked_sub(1).filter(|_| !jumped).map(|tick| &history[tick].0);
    (joints, before)
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
fn comfort() -> anyhow::Result<ErgonomicsQuadratic> {
    let hessian = Matrix3::from_diagonal(&Vector3::new(10.0, 5.0, 7.0));
    let best = Vector3::new(0.4, -0.1, 1.1);
    let least = 0.5 * best.dot(&(hessian * best));
    Ok(ErgonomicsQuadratic::new(hessian, -(hessian * best), least)?)
}
