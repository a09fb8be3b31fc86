//! Tasks of a robot.

use nalgebra::{Unit, Vector3, Vector6};
use pyo3::prelude::*;
use whole_body::Model;
use whole_body::robot::JointKind;
use whole_body::stack::TaskLevel;
use whole_body::tasks::{Axis, Feedback};

use super::targets::Target;
use crate::arrays::{direction, numbers};
use crate::failure::{Failure, Result};

/// Task of Python that can be made for a robot.
pub(crate) trait PythonTask: Send + Sync {
    /// Adds the robot's task to a level. The result sets its target.
    fn push(&self, model: &Model, level: &mut TaskLevel, name: &str) -> Result<Target>;
}

/// Rates at which errors decay, where they differ from the defaults.
#[derive(Debug, Clone, Copy)]
struct Gains {
    gain: Option<f64>,
    deceleration: Option<f64>,
}

impl Gains {
    fn feedback(self, default: Feedback) -> Feedback {
        Feedback {
            gain: self.gain.unwrap_or(default.gain),
            deceleration: self.deceleration.unwrap_or(default.deceleration),
        }
    }
}

/// Returns the given numbers, or ones.
fn weights<const N: usize>(weights: Option<&Bound<'_, PyAny>>) -> Result<[f64; N]> {
    weights.map_or(Ok([1.0; N]), |weights| numbers("weights", weights))
}

/// Reads axes from their letters.
fn axes(letters: &str) -> Result<Vec<Axis>> {
    let axis = |letter| match letter {
        'x' => Ok(Axis::X),
        'y' => Ok(Axis::Y),
        'z' => Ok(Axis::Z),
        _ => Err(Failure::value(format!(r#"axes is "{letters}"; it must be some of "xyz""#))),
    };
    letters.chars().map(axis).collect()
}

/// Defines a task of three coordinates.
macro_rules! vector_task {
    ($(#[$doc:meta])* $name:ident, $rust:ident, $target:ident, $feedback:ident) => {
        $(#[$doc])*
        #[pyclass(frozen, module = "ahqp.whole_body")]
        pub(crate) struct $name {
            frame: String,
            gains: Gains,
            axes: Vec<Axis>,
            weights: [f64; 3],
        }

        #[pymethods]
        impl $name {
            #[new]
            #[pyo3(signature = (frame, *, gain=None, deceleration=None, axes="xyz", weights=None))]
            fn new(
                frame: String,
                gain: Option<f64>,
                deceleration: Option<f64>,
                axes: &str,
                weights: Option<&Bound<'_, PyAny>>,
            ) -> Result<Self> {
                let (axes, weights) = (self::axes(axes)?, self::weights(weights)?);
                Ok(Self { frame, gains: Gains { gain, deceleration }, axes, weights })
            }
        }

        impl PythonTask for $name {
            fn push(&self, model: &Model, level: &mut TaskLevel, name: &str) -> Result<Target> {
                let task = whole_body::tasks::$rust::new(model.frame_id(&self.frame)?)
                    .with_feedback(self.gains.feedback(Feedback::$feedback))
                    .with_axes(&self.axes)
                    .with_weights(self.weights.into());
                Ok(Target::$target(level.push(name, task)))
            }
        }
    };
}

vector_task!(
    /// Brings the origin of a frame to a point of the world, along some of its axes.
    ///
    /// `PositionTask(frame, *, gain=None, deceleration=None, axes="xyz", weights=None)`: gain in 1/s,
    /// deceleration in m/s², weights (3,). Target: (3,) [m].
    PositionTask, PositionTask, Position, LINEAR
);
vector_task!(
    /// Turns a frame to an orientation in the world, about some of its axes.
    ///
    /// `OrientationTask(frame, *, gain=None, deceleration=None, axes="xyz", weights=None)`: gain in 1/s,
    /// deceleration in rad/s², weights (3,). Target: a rotation matrix, (3, 3), or a unit quaternion
    /// x, y, z, w.
    OrientationTask, OrientationTask, Orientation, ANGULAR
);

/// Brings the centre of mass to a point of the world, along some of its axes.
///
/// `CentreOfMassTask(*, gain=None, deceleration=None, axes="xyz", weights=None)`. Target: (3,) [m].
#[pyclass(frozen, module = "ahqp.whole_body")]
pub(crate) struct CentreOfMassTask {
    gains: Gains,
    axes: Vec<Axis>,
    weights: [f64; 3],
}

#[pymethods]
impl CentreOfMassTask {
    #[new]
    #[pyo3(signature = (*, gain=None, deceleration=None, axes="xyz", weights=None))]
    fn new(
        gain: Option<f64>,
        deceleration: Option<f64>,
        axes: &str,
        weights: Option<&Bound<'_, PyAny>>,
    ) -> Result<Self> {
        let (axes, weights) = (self::axes(axes)?, self::weights(weights)?);
        Ok(Self { gains: Gains { gain, deceleration }, axes, weights })
    }
}

impl PythonTask for CentreOfMassTask {
    fn push(&self, model: &Model, level: &mut TaskLevel, name: &str) -> Result<Target> {
        let task = whole_body::tasks::CentreOfMassTask::new(model)
            .with_feedback(self.gains.feedback(Feedback::LINEAR))
            .with_axes(&self.axes)
            .with_weights(self.weights.into());
        Ok(Target::CentreOfMass(level.push(name, task)))
    }
}

/// Brings a frame to a pose in the world.
///
/// `FrameTask(frame, *, gain=None, weights=None)`: gain in 1/s, weights (6,), linear then angular.
/// Target: (4, 4).
#[pyclass(frozen, module = "ahqp.whole_body")]
pub(crate) struct FrameTask {
    frame: String,
    gain: Option<f64>,
    weights: [f64; 6],
}

#[pymethods]
impl FrameTask {
    #[new]
    #[pyo3(signature = (frame, *, gain=None, weights=None))]
    fn new(frame: String, gain: Option<f64>, weights: Option<&Bound<'_, PyAny>>) -> Result<Self> {
        Ok(Self { frame, gain, weights: self::weights(weights)? })
    }
}

impl PythonTask for FrameTask {
    fn push(&self, model: &Model, level: &mut TaskLevel, name: &str) -> Result<Target> {
        let mut task = whole_body::tasks::FrameTask::new(model.frame_id(&self.frame)?)
            .with_weights(Vector6::from(self.weights));
        if let Some(gain) = self.gain {
            task = task.with_gain(gain);
        }
        Ok(Target::Frame(level.push(name, task)))
    }
}

/// Brings a frame to a pose in another frame of the robot.
///
/// `RelativeFrameTask(reference, frame, *, gain=None, weights=None)`: gain in 1/s, weights (6,), linear
/// then angular. Target: (4, 4), of `frame` in `reference`.
#[pyclass(frozen, module = "ahqp.whole_body")]
pub(crate) struct RelativeFrameTask {
    reference: String,
    frame: String,
    gain: Option<f64>,
    weights: [f64; 6],
}

#[pymethods]
impl RelativeFrameTask {
    #[new]
    #[pyo3(signature = (reference, frame, *, gain=None, weights=None))]
    fn new(
        reference: String,
        frame: String,
        gain: Option<f64>,
        weights: Option<&Bound<'_, PyAny>>,
    ) -> Result<Self> {
        Ok(Self { reference, frame, gain, weights: self::weights(weights)? })
    }
}

impl PythonTask for RelativeFrameTask {
    fn push(&self, model: &Model, level: &mut TaskLevel, name: &str) -> Result<Target> {
        let (reference, frame) = (model.frame_id(&self.reference)?, model.frame_id(&self.frame)?);
        let mut task = whole_body::tasks::RelativeFrameTask::new(reference, frame)
            .with_weights(Vector6::from(self.weights));
        if let Some(gain) = self.gain {
            task = task.with_gain(gain);
        }
        Ok(Target::RelativeFrame(level.push(name, task)))
    }
}

/// Turns an axis of a frame to a direction of the world.
///
/// `AxisTask(frame, axis, *, gain=None, deceleration=None, weight=1.0)`: axis (3,), in the frame.
/// Target: (3,), a direction in the world.
#[pyclass(frozen, module = "ahqp.whole_body")]
pub(crate) struct AxisTask {
    frame: String,
    axis: Unit<Vector3<f64>>,
    gains: Gains,
    weight: f64,
}

#[pymethods]
impl AxisTask {
    #[new]
    #[pyo3(signature = (frame, axis, *, gain=None, deceleration=None, weight=1.0))]
    fn new(
        frame: String,
        axis: &Bound<'_, PyAny>,
        gain: Option<f64>,
        deceleration: Option<f64>,
        weight: f64,
    ) -> Result<Self> {
        let axis = direction("axis", axis)?;
        Ok(Self { frame, axis, gains: Gains { gain, deceleration }, weight })
    }
}

impl PythonTask for AxisTask {
    fn push(&self, model: &Model, level: &mut TaskLevel, name: &str) -> Result<Target> {
        let task = whole_body::tasks::AxisTask::new(model.frame_id(&self.frame)?, self.axis)
            .with_feedback(self.gains.feedback(Feedback::ANGULAR))
            .with_weight(self.weight);
        Ok(Target::Axis(level.push(name, task)))
    }
}

/// Brings joints to a configuration. As the last task it decides the motions that no other task decides.
///
/// `PostureTask(joints=None, *, gain=None, deceleration=None, weights=None)`: names of joints, None for
/// all; gain in 1/s, weights (joints,). Target: a whole q, (position_count,).
#[pyclass(frozen, module = "ahqp.whole_body")]
pub(crate) struct PostureTask {
    joints: Option<Vec<String>>,
    gains: Gains,
    weights: Vec<f64>,
}

#[pymethods]
impl PostureTask {
    #[new]
    #[pyo3(signature = (joints=None, *, gain=None, deceleration=None, weights=None))]
    fn new(
        joints: Option<Vec<String>>,
        gain: Option<f64>,
        deceleration: Option<f64>,
        weights: Option<&Bound<'_, PyAny>>,
    ) -> Result<Self> {
        let weights = list(weights)?;
        Ok(Self { joints, gains: Gains { gain, deceleration }, weights })
    }
}

/// Returns weights of any number; empty if there are none.
fn list(weights: Option<&Bound<'_, PyAny>>) -> Result<Vec<f64>> {
    weights.map_or(Ok(Vec::new()), |weights| {
        Ok(crate::arrays::vector("weights", weights)?.as_array().to_vec())
    })
}

impl PythonTask for PostureTask {
    fn push(&self, model: &Model, level: &mut TaskLevel, name: &str) -> Result<Target> {
        let mut task = whole_body::tasks::PostureTask::new()
            .with_feedback(self.gains.feedback(Feedback::JOINT))
            .with_weights(&self.weights);
        if let Some(joints) = &self.joints {
            let ids = joints.iter().map(|joint| Ok(model.joint_id(joint)?));
            task = task.of_joints(&ids.collect::<Result<Vec<_>>>()?);
        }
        let all = model.joints().iter().filter(|joint| joint.kind != JointKind::Floating);
        let rows = self.joints.as_ref().map_or(all.count(), Vec::len);
        Ok(Target::Posture(level.push(name, task), rows))
    }
}

/// Asks all joints to rest.
///
/// `DampingTask(*, weights=None)`: weights (n,). It has no target.
#[pyclass(frozen, module = "ahqp.whole_body")]
pub(crate) struct DampingTask {
    weights: Vec<f64>,
}

#[pymethods]
impl DampingTask {
    #[new]
    #[pyo3(signature = (*, weights=None))]
    fn new(weights: Option<&Bound<'_, PyAny>>) -> Result<Self> {
        Ok(Self { weights: list(weights)? })
    }
}

impl PythonTask for DampingTask {
    fn push(&self, _model: &Model, level: &mut TaskLevel, name: &str) -> Result<Target> {
        let task = whole_body::tasks::DampingTask::new().with_weights(&self.weights);
        Ok(Target::Damping(level.push(name, task)))
    }
}

/// Keeps Σ cᵢ qᵢ of some joints at a value: two fingers that move together, a lift of two halves.
///
/// `JointCouplingTask(joints, *, weight=1.0)`: a dict of names to coefficients. Target: a number, zero
/// at first.
#[pyclass(frozen, module = "ahqp.whole_body")]
pub(crate) struct JointCouplingTask {
    joints: Vec<(String, f64)>,
    weight: f64,
}

#[pymethods]
impl JointCouplingTask {
    #[new]
    #[pyo3(signature = (joints, *, weight=1.0))]
    fn new(joints: &Bound<'_, pyo3::types::PyDict>, weight: f64) -> Result<Self> {
        let joints = joints.iter().map(|(name, value)| Ok((name.extract()?, value.extract()?)));
        Ok(Self { joints: joints.collect::<Result<_>>()?, weight })
    }
}

impl PythonTask for JointCouplingTask {
    fn push(&self, model: &Model, level: &mut TaskLevel, name: &str) -> Result<Target> {
        let joint = |(name, coefficient): &(String, f64)| Ok((model.joint_id(name)?, *coefficient));
        let joints = self.joints.iter().map(joint).collect::<Result<Vec<_>>>()?;
        let task = whole_body::tasks::JointCouplingTask::new(&joints).with_weight(self.weight);
        Ok(Target::JointCoupling(level.push(name, task)))
    }
}

/// Rows lower ≤ A q̇ ≤ upper that the caller writes, as a task or as a hard limit: velocities, distances to obstacles,
/// rows of another program. Rows that were not written bound nothing.
///
/// `VelocityTask(rows, *, weights=None)`: the number of rows, weights (rows,). `Ik.set_rows` writes them.
#[pyclass(frozen, module = "ahqp.whole_body")]
pub(crate) struct VelocityTask {
    rows: usize,
    weights: Vec<f64>,
}

#[pymethods]
impl VelocityTask {
    #[new]
    #[pyo3(signature = (rows, *, weights=None))]
    fn new(rows: usize, weights: Option<&Bound<'_, PyAny>>) -> Result<Self> {
        let weights = list(weights)?;
        if !weights.is_empty() && weights.len() != rows {
            let found = weights.len();
            return Err(Failure::value(format!(
                "weights has {found} entries; it must have {rows}"
            )));
        }
        if !(1..=MOST_ROWS).contains(&rows) {
            return Err(Failure::value(format!("rows is {rows}; it must be 1 to {MOST_ROWS}")));
        }
        Ok(Self { rows, weights })
    }
}

/// Largest number of rows of a task.
const MOST_ROWS: usize = 1000;

impl VelocityTask {
    /// Returns the number of rows.
    pub(crate) fn count(&self) -> usize {
        self.rows
    }

    /// Returns the task, without any row yet.
    pub(crate) fn rows(&self) -> Result<whole_body::tasks::VelocityTask> {
        let mut task = whole_body::tasks::VelocityTask::new(self.rows);
        for (row, weight) in self.weights.iter().enumerate() {
            task.set_weight(row, *weight)?;
        }
        Ok(task)
    }
}

impl PythonTask for VelocityTask {
    fn push(&self, _model: &Model, level: &mut TaskLevel, name: &str) -> Result<Target> {
        Ok(Target::Velocity(level.push(name, self.rows()?), self.rows))
    }
}
