//! The controller.

use std::time::Instant;

use moca_model::whole_body::control_loop::JointMeasurement;
use moca_model::{AnswerDelay, Goal, TorqueController};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use vision_models::Percept;

use super::command::Command;
use super::object::GraspedObject;
use super::robot::Robot;
use super::scene::Scene;
use super::settings::{Settings, compensation};
use super::tables;
use crate::arrays::{pose_to_array, to_vector, vector, vector_of};
use crate::ergo::keywords::word;
use crate::ergo::map::Quadratic;
use crate::failure::{Failure, Result};
use crate::shared::Shared;
use crate::whole_body::bodies::BodyOfLink;
use crate::whole_body::model::Model;

/// Ergonomic collaboration with a person. The robot follows the person, and brings their hand to where work is easy. It
/// keeps all of its limits, and its distances to people. This is not safety-rated software.
///
/// `Controller(model, start, tool, person=None, *, bodies=(), own_pairs=(), mecanum=None, compensation=None,
/// settings=None)`, and `Controller.moca(person=None, *, start=None, compensation=None, settings=None)` for MOCA
///
/// Parameters
/// ----------
/// model : ahqp.whole_body.Model
///     The robot, on a fixed or a planar base.
/// start : array_like, (n,)
///     Its configuration, at rest [m, rad]. It is also the preferred posture.
/// tool : str
///     The frame that works with the person.
/// person : ahqp.ergo.Person or ahqp.ergo.ErgonomicsMap, optional
///     Of average stature if not given. A map is built for a person, which takes seconds.
/// bodies : sequence of (str, array_like, array_like, float)
///     Capsules of the robot that keep their distances: link, start and end in the link's frame [m], radius [m]. A
///     robot without them keeps no distance from people.
/// own_pairs : sequence of (str, str)
///     Links whose capsules are also kept apart from each other.
/// mecanum : (float, float, float), optional
///     Of a planar base on mecanum wheels: largest |v_x| + |v_y| + lever |ω| [m/s], lever [m], and largest speed along
///     each of its axes [m/s].
/// compensation : str, optional
///     For robots that take torques: what the robot adds to them by itself, "nothing" or "franka" (gravity and
///     friction). Commands then have torques. A controller without it only has velocities and positions.
/// settings : dict or path, optional
///     Tables "controller" and "torque" of a settings file of the programs, or the file. `Controller.settings` has all.
///
/// Each camera frame goes to `observe`, and each measured state to `step`, once a millisecond. Steps release the
/// interpreter's lock.
///
/// >>> from ahqp.collaboration import Body, Controller, Scene
/// >>> from ahqp.ergo import ErgonomicsMap, Person
/// >>> person = Person(1.75)
/// >>> controller = Controller.moca(ErgonomicsMap(person, spacing=0.1))
/// >>> controller.observe(Scene(Body.standing(person, [1.7, 0.0], 3.14159), action="Using The Drill"))
/// >>> command = controller.step(controller.position)
/// >>> command.velocity.shape, command.is_optimal, command.safety
/// ((10,), True, 'normal')
#[pyclass(frozen, module = "ahqp.collaboration")]
pub(crate) struct Controller(Shared<State>);

/// The controller with or without its torque law.
#[derive(Debug)]
enum Law {
    Velocity(Box<moca_model::Controller>),
    Torque(Box<TorqueController>),
}

#[derive(Debug)]
struct State {
    law: Law,
    torque: moca_model::TorqueLoopSettings,
    /// Time of the last step [s].
    time: f64,
    has_begun: bool,
    /// Measurements of the present step.
    measured: JointMeasurement,
}

impl State {
    fn controller(&self) -> &moca_model::Controller {
        match &self.law {
            Law::Velocity(controller) => controller,
            Law::Torque(controller) => controller.controller(),
        }
    }

    fn controller_mut(&mut self) -> &mut moca_model::Controller {
        match &mut self.law {
            Law::Velocity(controller) => controller,
            Law::Torque(controller) => controller.controller_mut(),
        }
    }

    /// Makes a step with the measurements that were written.
    fn step(&mut self, age: f64) -> Result<()> {
        self.measured.age = age;
        match &mut self.law {
            Law::Velocity(controller) => {
                controller.step(self.time, &self.measured.position)?;
            }
            Law::Torque(controller) => {
                if !std::mem::replace(&mut self.has_begun, true) {
                    controller.begin(&self.measured)?;
                }
                controller.step(self.time, &self.measured)?;
            }
        }
        Ok(())
    }

    fn command(&self, duration: f64) -> Command {
        let controller = self.controller();
        let supervisor = controller.safety().supervisor();
        let torque = match &self.law {
            Law::Velocity(_) => None,
            Law::Torque(law) => {
                let mut all = vec![0.0; self.measured.torque.len()];
                for (joint, torque) in law.joints().iter().zip(law.torque()) {
                    if let Some(place) = all.get_mut(*joint) {
                        *place = *torque;
                    }
                }
                Some(all)
            }
        };
        Command {
            told: controller.command().clone(),
            torque,
            cause: supervisor.cause().copied(),
            waits_for: supervisor.unacknowledged(),
            duration,
        }
    }
}

impl Controller {
    fn build(
        py: Python<'_>,
        mut robot: Robot,
        person: Option<&Bound<'_, PyAny>>,
        adds: Option<&str>,
        settings: Option<&Bound<'_, PyAny>>,
    ) -> Result<Self> {
        let adds = adds.map(compensation).transpose()?;
        let ergonomics = robot.beside(py, person)?;
        let Robot { model, start, settings: own } = robot;
        let Settings { controller, mut torque } = own.with(settings)?;
        let controller = moca_model::Controller::new(model, ergonomics, controller, &start)?;
        let joints = start.len();
        let law = match adds {
            None => Law::Velocity(Box::new(controller)),
            Some(adds) => {
                torque.compensation = adds;
                if torque.delay == AnswerDelay::Measured {
                    // Only the loop of the programs measures it.
                    torque.delay = AnswerDelay::Known(0.0);
                }
                Law::Torque(Box::new(TorqueController::new(controller, torque.clone())?))
            }
        };
        let state = State {
            law,
            torque,
            time: 0.0,
            has_begun: false,
            measured: JointMeasurement::resting(start, joints),
        };
        Ok(Self(Shared::new("Controller", state)))
    }
}

#[pymethods]
impl Controller {
    #[new]
    #[pyo3(signature = (model, start, tool, person=None, *, bodies=Vec::new(), own_pairs=Vec::new(), mecanum=None, compensation=None, settings=None))]
    #[allow(clippy::too_many_arguments)] // keywords of Python
    fn new(
        py: Python<'_>,
        model: &Model,
        start: &Bound<'_, PyAny>,
        tool: String,
        person: Option<&Bound<'_, PyAny>>,
        bodies: Vec<BodyOfLink<'_>>,
        own_pairs: Vec<(String, String)>,
        mecanum: Option<[f64; 3]>,
        compensation: Option<&str>,
        settings: Option<&Bound<'_, PyAny>>,
    ) -> Result<Self> {
        let robot = Robot::new(&model.0, start, tool, bodies, &own_pairs, mecanum)?;
        Self::build(py, robot, person, compensation, settings)
    }

    /// The controller of MOCA, a Panda on a mobile base, at its home or at `start`, (10,). Its joints are base_x, base_y,
    /// base_yaw and panda_joint1 to 7. The other parameters are those of `Controller`.
    #[staticmethod]
    #[pyo3(signature = (person=None, *, start=None, compensation=None, settings=None))]
    fn moca(
        py: Python<'_>,
        person: Option<&Bound<'_, PyAny>>,
        start: Option<&Bound<'_, PyAny>>,
        compensation: Option<&str>,
        settings: Option<&Bound<'_, PyAny>>,
    ) -> Result<Self> {
        Self::build(py, Robot::moca(start)?, person, compensation, settings)
    }

    /// Takes a camera frame. People without ids are told apart by their places. `now` is the present on the clock of the steps [s], where that is not the time of the last
    /// step.
    ///
    /// Raises `FrameError` for a frame that counts as no data. The safety state knows of it, and the loop may go on.
    #[pyo3(signature = (scene, *, now=None))]
    fn observe(&self, scene: &Scene, now: Option<f64>) -> Result<()> {
        let mut state = self.0.lock()?;
        let present = now.unwrap_or(state.time);
        let time = if scene.is_timed { scene.percept.time } else { present };
        let percept = Percept { time, ..scene.percept.clone() };
        let controller = state.controller_mut();
        if now.is_some() {
            controller.set_present(present);
        }
        Ok(controller.observe(moca_model::Scene::from(percept).with_others(&scene.others))?)
    }

    /// The command for the next period, with the robot as it was measured: `q`, (n,), `dt` after the last step [s], the
    /// period if not given. A controller with a torque law also needs `velocity`, (n,). It notices contacts if it
    /// gets the torques at the links, `torque`, (n,). NaN stands for joints that measure none. `age` is the time since the measurement [s].
    ///
    /// A step that cannot be computed brakes the robot within its limits, and `Command.fault` says why.
    #[pyo3(signature = (q, dt=None, *, velocity=None, torque=None, age=0.0))]
    fn step(
        slf: &Bound<'_, Self>,
        q: &Bound<'_, PyAny>,
        dt: Option<f64>,
        velocity: Option<&Bound<'_, PyAny>>,
        torque: Option<&Bound<'_, PyAny>>,
        age: f64,
    ) -> Result<Command> {
        let py = slf.py();
        let mut state = slf.get().0.lock()?;
        let state = &mut *state;
        let joints = state.measured.torque.len();
        let q = vector("q", q)?;
        state.measured.position.clear();
        state.measured.position.extend(q.as_array());
        if matches!(state.law, Law::Torque(_)) {
            let Some(velocity) = velocity else {
                let text = "step needs velocity=…: the springs and dampers of a torque law do";
                return Err(Failure::value(text));
            };
            let velocity = vector_of("velocity", velocity, joints)?;
            state.measured.velocity.clear();
            state.measured.velocity.extend(velocity.as_array());
            match torque {
                None => state.measured.torque.fill(None),
                Some(torque) => {
                    let torque = vector_of("torque", torque, joints)?;
                    let known = torque.as_array();
                    for (own, torque) in state.measured.torque.iter_mut().zip(known) {
                        *own = (!torque.is_nan()).then_some(*torque);
                    }
                }
            }
        }
        let period = state.controller().settings().period;
        state.time += dt.unwrap_or(period);
        py.detach(|| {
            let begun = Instant::now();
            state.step(age)?;
            Ok(state.command(begun.elapsed().as_secs_f64()))
        })
    }

    /// Acknowledges the stop that waits for it: somebody has seen to the robot.
    fn acknowledge(&self) -> Result<()> {
        self.0.lock()?.controller_mut().safety_mut().supervisor_mut().acknowledge();
        Ok(())
    }

    /// Asks the robot to stop, until `acknowledge`.
    fn request_stop(&self) -> Result<()> {
        self.0.lock()?.controller_mut().request_stop();
        Ok(())
    }

    /// Reports that the robot stopped by itself and takes no command in the coming step.
    fn robot_stopped(&self) -> Result<()> {
        self.0.lock()?.controller_mut().robot_stopped();
        Ok(())
    }

    /// Takes the force from outside that was measured for the coming step [N]. Too large a force stops the robot. A
    /// robot without this measurement keeps its distance from everybody. A torque law estimates it from the torques.
    fn set_external_force(&self, force: f64) -> Result<()> {
        let mut state = self.0.lock()?;
        if matches!(state.law, Law::Torque(_)) {
            let text = "a torque law estimates the force by itself; give step torque=…";
            return Err(Failure::value(text));
        }
        state.controller_mut().set_external_force(force);
        Ok(())
    }

    /// Sets the object that the gripper has taken.
    fn grasp(&self, object: &GraspedObject) -> Result<()> {
        match &mut self.0.lock()?.law {
            Law::Velocity(controller) => controller.grasp(object.0.clone())?,
            Law::Torque(controller) => controller.grasp(object.0.clone())?,
        }
        Ok(())
    }

    /// Tells that the gripper holds nothing any more. Returns the object that it held.
    fn release(&self) -> Result<Option<GraspedObject>> {
        let released = match &mut self.0.lock()?.law {
            Law::Velocity(controller) => controller.release()?,
            Law::Torque(controller) => controller.release()?,
        };
        Ok(released.map(GraspedObject))
    }

    /// Asks for the person's ergonomics from now on, "ergonomics", or for the least motion, "least_motion".
    fn set_goal(&self, goal: &str) -> Result<()> {
        let known = [("ergonomics", Goal::Ergonomics), ("least_motion", Goal::LeastMotion)];
        self.0.lock()?.controller_mut().set_goal(word("goal", goal, &known)?);
        Ok(())
    }

    /// Sets the ergonomics of another person, as `ErgonomicsMap.fit` returns them.
    fn set_ergonomics(&self, ergonomics: &Quadratic) -> Result<()> {
        self.0.lock()?.controller_mut().set_ergonomics(ergonomics.0);
        Ok(())
    }

    /// The robot.
    #[getter]
    fn model(&self) -> Result<Model> {
        Ok(Model(self.0.lock()?.controller().robot().model().clone()))
    }

    /// The configuration of the last step, (n,); the start before it.
    #[getter]
    fn position<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray1<f64>>> {
        Ok(to_vector(py, &self.0.lock()?.measured.position))
    }

    /// The time of the last step [s], 0 before the first.
    #[getter]
    fn time(&self) -> Result<f64> {
        Ok(self.0.lock()?.time)
    }

    /// The pose of the tool at the last step, or of the hand that works on the object it holds, in the world, (4, 4).
    #[getter]
    fn hand<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray2<f64>>> {
        Ok(pose_to_array(py, &self.0.lock()?.controller().actual()))
    }

    /// The person as tracked: a dict of floor, (2,) [m], heading [rad], velocity, (2,) [m/s], and age [s]; None if
    /// nobody was seen.
    #[getter]
    fn person<'py>(&self, py: Python<'py>) -> Result<Option<Bound<'py, PyDict>>> {
        let state = self.0.lock()?;
        let Some(person) = state.controller().situation().worker else { return Ok(None) };
        let dict = PyDict::new(py);
        dict.set_item("floor", to_vector(py, person.floor.coords.as_slice()))?;
        dict.set_item("heading", person.heading)?;
        dict.set_item("velocity", to_vector(py, person.velocity.as_slice()))?;
        dict.set_item("age", person.age)?;
        Ok(Some(dict))
    }

    /// The least room to a protective distance at the last step [m], negative if it is violated; None if nobody is
    /// there.
    #[getter]
    fn room(&self) -> Result<Option<f64>> {
        let state = self.0.lock()?;
        Ok(state.controller().safety().nearest().map(hrsw_safety::Nearest::room))
    }

    /// The estimated force on the tool from outside, in the world [N], (3,); None without a torque law.
    #[getter]
    fn external_force<'py>(&self, py: Python<'py>) -> Result<Option<Bound<'py, PyArray1<f64>>>> {
        Ok(match &self.0.lock()?.law {
            Law::Velocity(_) => None,
            Law::Torque(law) => Some(to_vector(py, law.external_force().as_slice())),
        })
    }

    /// Settings as a dict of the tables "controller" and "torque".
    #[getter]
    fn settings<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyAny>> {
        let state = self.0.lock()?;
        let (controller, torque) = (state.controller().settings().clone(), state.torque.clone());
        let table = Settings { controller, torque }.table()?;
        Ok(tables::to_python(py, &toml::Value::Table(table))?)
    }

    fn __repr__(&self) -> Result<String> {
        let state = self.0.lock()?;
        Ok(format!(
            "<ahqp.collaboration.Controller: {}>",
            state.controller().robot().model().name()
        ))
    }
}
