//! Inverse kinematics.

use std::collections::HashMap;

use ahqp_core::{Budget, VelocityInterval};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use whole_body::ik::IkSettings;
use whole_body::limits::{End, LimitKind};
use whole_body::stack::TaskLevel;

use super::limits::Limit;
use super::model::Model;
use super::targets::{Target, write_rows};
use super::tasks::{
    AxisTask, CentreOfMassTask, DampingTask, FrameTask, JointCouplingTask, OrientationTask,
    PositionTask, PostureTask, PythonTask, RelativeFrameTask, VelocityTask,
};
use crate::arrays::{pose_to_array, to_vector, vector_of, with_slice};
use crate::failure::{Failure, Result};
use crate::shared::Shared;

/// Differential inverse kinematics: velocities for levels of tasks within the limits of all joints. Each level is
/// fulfilled as well as the levels above it allow.
///
/// `Ik(model, tasks, hold=None, *, limits=None, singularity_threshold=0.1, iterations=None)`
///
/// Parameters
/// ----------
/// model : Model
/// tasks : dict
///     Tasks by their names, highest priority first. A dict in place of a task is a level of several tasks.
/// hold : array_like, shape (position_count,), optional
///     The configuration of the robot at rest: tasks without a target hold the state there.
/// limits : dict of str to WheelLimit, FrameVelocityLimit, SelfCollisionLimit or VelocityTask, optional
///     Hard limits in addition to those of the joints.
/// singularity_threshold : float
///     Singular value below which directions are damped, from 0 (never) to 1.
/// iterations : int, optional
///     Largest number of iterations of one step.
///
/// Limits never contradict each other, and hold in every step. Steps release the interpreter's lock. Tasks and limits
/// stay, and change from step to step: targets, rows, weights (0 switches a task off), and joints that stand.
#[pyclass(frozen, module = "ahqp.whole_body")]
pub(crate) struct Ik(Shared<State>);

#[derive(Debug)]
struct State {
    ik: whole_body::Ik,
    targets: HashMap<String, Target>,
    /// Limits with rows of the caller.
    limits: HashMap<String, Target>,
}

#[pymethods]
impl Ik {
    #[new]
    #[pyo3(signature = (model, tasks, hold=None, *, limits=None, singularity_threshold=0.1, iterations=None))]
    fn new(
        model: &Model,
        tasks: &Bound<'_, PyDict>,
        hold: Option<&Bound<'_, PyAny>>,
        limits: Option<&Bound<'_, PyDict>>,
        singularity_threshold: f64,
        iterations: Option<usize>,
    ) -> Result<Self> {
        let model = &model.0;
        let mut builder = whole_body::Ik::builder(model);
        builder.settings(IkSettings {
            budget: Budget { iterations, time: None },
            singularity_threshold,
            ..IkSettings::default()
        });
        let mut rows = HashMap::new();
        for (name, limit) in limits.into_iter().flatten() {
            let name: String = name.extract()?;
            if let Some(limit) = limit.extract::<Limit<'_>>()?.add(model, &name, &mut builder)? {
                rows.insert(name, limit);
            }
        }
        let mut targets = HashMap::new();
        for (name, value) in tasks {
            let name: String = name.extract()?;
            let mut level = TaskLevel::new(name.as_str());
            match value.cast::<PyDict>() {
                Ok(tasks) => {
                    for (name, task) in tasks {
                        push(model, &mut level, name.extract()?, &task, &mut targets)?;
                    }
                }
                Err(_) => push(model, &mut level, name, &value, &mut targets)?,
            }
            builder.push_level(level);
        }
        let ik = match hold {
            None => builder.build()?,
            Some(q) => {
                let q = vector_of("hold", q, model.position_count())?;
                with_slice(&q, |q| builder.build_at(q))?
            }
        };
        Ok(Self(Shared::new("Ik", State { ik, targets, limits: rows })))
    }

    /// Sets the target of a task and its velocity: (3,) for a point or an orientation in the world's axes, (6,) for a
    /// pose. Each task documents its own target.
    #[pyo3(signature = (task, target, velocity=None))]
    fn set_target(
        &self,
        task: &str,
        target: &Bound<'_, PyAny>,
        velocity: Option<&Bound<'_, PyAny>>,
    ) -> Result<()> {
        let mut state = self.0.lock()?;
        let State { ik, targets, .. } = &mut *state;
        find(targets, task)?.set(ik, target, velocity)
    }

    /// Writes the rows lower ≤ A q̇ ≤ upper of a VelocityTask or of such a limit, which hold until they are written
    /// again: A (rows, n), lower and upper (rows,), infinite where there is no bound.
    #[allow(non_snake_case)] // the matrix's name
    fn set_rows(
        &self,
        task: &str,
        A: &Bound<'_, PyAny>,
        lower: &Bound<'_, PyAny>,
        upper: &Bound<'_, PyAny>,
    ) -> Result<()> {
        let mut state = self.0.lock()?;
        let State { ik, targets, limits } = &mut *state;
        let found = limits.get(task).copied().map_or_else(|| find(targets, task), Ok)?;
        let Target::Velocity(id, count) = found else {
            return Err(Failure::value(format!(
                "task `{task}` is no VelocityTask: it has no rows"
            )));
        };
        write_rows(ik.task_mut(id)?, count, [A, lower, upper])
    }

    /// Sets other weights of a task, of the shape that it documents. Weights of 0 switch it off.
    fn set_weights(&self, task: &str, weights: &Bound<'_, PyAny>) -> Result<()> {
        let mut state = self.0.lock()?;
        let State { ik, targets, .. } = &mut *state;
        find(targets, task)?.weigh(ik, weights)
    }

    /// The velocities for the next `period` [s], with the robot at the configuration `q`, shape
    /// (position_count,), and the velocity of the last step. `within` is a dict of joints to their lowest and highest
    /// velocities [rad/s or m/s]. It counts as far as their limits allow, and (0, 0) lets a joint stand.
    ///
    /// Raises `Error` for a target that was never set, or an invalid q; `brake` stops the robot.
    #[pyo3(signature = (q, period, within=None))]
    fn step(
        slf: &Bound<'_, Self>,
        q: &Bound<'_, PyAny>,
        period: f64,
        within: Option<&Bound<'_, PyDict>>,
    ) -> Result<Step> {
        let py = slf.py();
        let mut state = slf.get().0.lock()?;
        let State { ik, targets, .. } = &mut *state;
        let q = vector_of("q", q, ik.model().position_count())?.as_array().to_vec();
        let within = intervals(ik.model(), within)?;
        py.detach(|| {
            let step = ik.step_within(&q, period, &within)?;
            let slack =
                |(name, target): (&String, &Target)| Ok((name.clone(), target.slack(step)?));
            let mut end = q;
            step.integrate(&mut end)?;
            let limits = step
                .active_limits()
                .map(|limit| (limit.name.to_owned(), kind_name(limit.kind), end_name(limit.end)));
            Ok(Step {
                velocity: step.velocity().to_vec(),
                acceleration: step.acceleration().to_vec(),
                end,
                slack: targets.iter().map(slack).collect::<Result<_>>()?,
                active_limits: limits.collect(),
                status: crate::solver::solution::name(step.status()),
                iterations: step.iterations(),
            })
        })
    }

    /// Brakes every joint for a period [s], at the limits of acceleration and jerk, for use when `step` fails. Returns
    /// the velocities, (n,).
    fn brake<'py>(&self, py: Python<'py>, period: f64) -> Result<Bound<'py, PyArray1<f64>>> {
        Ok(to_vector(py, self.0.lock()?.ik.brake(period)?))
    }

    /// Sets the current velocity of the robot, (n,), without acceleration.
    fn reset(&self, velocity: &Bound<'_, PyAny>) -> Result<()> {
        let mut state = self.0.lock()?;
        let velocity = vector_of("velocity", velocity, state.ik.model().velocity_count())?;
        Ok(with_slice(&velocity, |velocity| state.ik.reset(velocity))?)
    }

    /// Sets the targets that were never set to the state at q, (position_count,).
    fn hold(&self, q: &Bound<'_, PyAny>) -> Result<()> {
        let mut state = self.0.lock()?;
        let q = vector_of("q", q, state.ik.model().position_count())?;
        Ok(with_slice(&q, |q| state.ik.hold(q))?)
    }

    /// The pose of a frame in the world at q, (4, 4).
    fn pose<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        frame: &str,
    ) -> Result<Bound<'py, PyArray2<f64>>> {
        let mut state = self.0.lock()?;
        let q = vector_of("q", q, state.ik.model().position_count())?;
        let frame = state.ik.model().frame_id(frame)?;
        Ok(pose_to_array(py, &with_slice(&q, |q| state.ik.pose(q, frame))?))
    }
}

/// Adds a task of any kind to a level.
fn push(
    model: &whole_body::Model,
    level: &mut TaskLevel,
    name: String,
    task: &Bound<'_, PyAny>,
    targets: &mut HashMap<String, Target>,
) -> Result<()> {
    macro_rules! first_of {
        ($($kind:ident),*) => {
            $(if let Ok(task) = task.cast::<$kind>() { task.get().push(model, level, &name)? } else)* {
                let kind = task.get_type();
                return Err(Failure::type_of_argument(format!(
                    "task `{name}` is a {kind}; give a task of ahqp.whole_body, or a dict of them"
                )));
            }
        };
    }
    let target = first_of!(
        PositionTask,
        OrientationTask,
        CentreOfMassTask,
        FrameTask,
        RelativeFrameTask,
        AxisTask,
        PostureTask,
        DampingTask,
        JointCouplingTask,
        VelocityTask
    );
    if targets.insert(name.clone(), target).is_some() {
        return Err(Failure::value(format!("there are two tasks named `{name}`")));
    }
    Ok(())
}

fn find(targets: &HashMap<String, Target>, name: &str) -> Result<Target> {
    targets.get(name).copied().ok_or_else(|| {
        let mut names: Vec<_> = targets.keys().map(String::as_str).collect();
        names.sort_unstable();
        let known = names.join(", ");
        Failure::value(format!("there is no task `{name}`; the tasks are {known}"))
    })
}

/// Returns an interval of velocities for each entry of q̇, or none at all. Other joints than those of `within` are free.
fn intervals(
    model: &whole_body::Model,
    within: Option<&Bound<'_, PyDict>>,
) -> Result<Vec<VelocityInterval>> {
    let Some(within) = within else { return Ok(Vec::new()) };
    let free = VelocityInterval { lower: f64::NEG_INFINITY, upper: f64::INFINITY };
    let mut intervals = vec![free; model.velocity_count()];
    for (joint, range) in within {
        let (joint, (lower, upper)): (String, (f64, f64)) = (joint.extract()?, range.extract()?);
        if lower.is_nan() || upper.is_nan() || lower > upper {
            let text =
                format!("within[\"{joint}\"] is ({lower}, {upper}); give the lower one first");
            return Err(Failure::value(text));
        }
        let index = model.joint(model.joint_id(&joint)?)?.velocity_index;
        if let Some(interval) = intervals.get_mut(index) {
            *interval = VelocityInterval { lower, upper };
        }
    }
    Ok(intervals)
}

fn kind_name(kind: LimitKind) -> &'static str {
    match kind {
        LimitKind::Position => "position",
        LimitKind::Velocity => "velocity",
        LimitKind::Acceleration => "acceleration",
        LimitKind::Jerk => "jerk",
        LimitKind::Caller => "caller",
    }
}

fn end_name(end: End) -> &'static str {
    match end {
        End::Lower => "lower",
        End::Upper => "upper",
    }
}

/// The velocity of one step, and what limited it. n is the size of q̇.
#[pyclass(frozen, module = "ahqp.whole_body")]
pub(crate) struct Step {
    velocity: Vec<f64>,
    acceleration: Vec<f64>,
    end: Vec<f64>,
    slack: HashMap<String, f64>,
    active_limits: Vec<(String, &'static str, &'static str)>,
    status: &'static str,
    iterations: usize,
}

#[pymethods]
impl Step {
    /// q̇ for the next period [rad/s, m/s], (n,).
    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        to_vector(py, &self.velocity)
    }

    /// (q̇ − the last q̇) / period [rad/s², m/s²], (n,).
    #[getter]
    fn acceleration<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        to_vector(py, &self.acceleration)
    }

    /// q after the period, (position_count,).
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        to_vector(py, &self.end)
    }

    /// The violation of each task, by its name: the distance from the velocities that it asks for.
    #[getter]
    fn slack(&self) -> HashMap<String, f64> {
        self.slack.clone()
    }

    /// The joints that a limit keeps from another motion: (joint, limit, "lower" or "upper"). The limit is "position",
    /// "velocity", "acceleration" or "jerk". The joint is the one that has the limit, which may be one that mimics the
    /// joint of q̇.
    #[getter]
    fn active_limits(&self) -> Vec<(String, &'static str, &'static str)> {
        self.active_limits.clone()
    }

    /// "solved", "iteration_limit" or "time_limit". Limits hold in any case.
    #[getter]
    fn status(&self) -> &'static str {
        self.status
    }

    /// Iterations of the solver.
    #[getter]
    fn iterations(&self) -> usize {
        self.iterations
    }
}
