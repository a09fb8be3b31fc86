//! Targets of tasks.

use nalgebra::{Point3, Vector3, Vector6};
use pyo3::prelude::*;
use whole_body::Ik;
use whole_body::ik::Step;
use whole_body::stack::TaskId;
use whole_body::tasks::{
    AxisTask, CentreOfMassTask, DampingTask, FrameTask, JointCouplingTask, OrientationTask,
    PositionTask, PostureTask, RelativeFrameTask, VelocityTask,
};

use crate::arrays::{Matrix, direction, numbers, orientation, pose, vector_of, with_slice};
use crate::failure::{Failure, Result};

/// Task of an `Ik`, whose target can be set.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Target {
    Position(TaskId<PositionTask>),
    Orientation(TaskId<OrientationTask>),
    CentreOfMass(TaskId<CentreOfMassTask>),
    Frame(TaskId<FrameTask>),
    RelativeFrame(TaskId<RelativeFrameTask>),
    Axis(TaskId<AxisTask>),
    /// A posture, and the number of its joints.
    Posture(TaskId<PostureTask>, usize),
    Damping(TaskId<DampingTask>),
    JointCoupling(TaskId<JointCouplingTask>),
    /// Rows of the caller, and their number.
    Velocity(TaskId<VelocityTask>, usize),
}

impl Target {
    /// Sets a target and its velocity.
    pub(crate) fn set(
        self,
        ik: &mut Ik,
        target: &Bound<'_, PyAny>,
        velocity: Option<&Bound<'_, PyAny>>,
    ) -> Result<()> {
        match self {
            Self::Position(id) => {
                let point = Point3::from(numbers::<3>("target", target)?);
                Ok(ik.task_mut(id)?.set_moving_target(point, linear(velocity)?)?)
            }
            Self::CentreOfMass(id) => {
                let point = Point3::from(numbers::<3>("target", target)?);
                Ok(ik.task_mut(id)?.set_moving_target(point, linear(velocity)?)?)
            }
            Self::Orientation(id) => {
                let orientation = orientation("target", target)?;
                Ok(ik.task_mut(id)?.set_moving_target(orientation, linear(velocity)?)?)
            }
            Self::Frame(id) => {
                let pose = pose("target", target)?;
                Ok(ik.task_mut(id)?.set_moving_target(pose, twist(velocity)?)?)
            }
            Self::RelativeFrame(id) => {
                let pose = pose("target", target)?;
                Ok(ik.task_mut(id)?.set_moving_target(pose, twist(velocity)?)?)
            }
            Self::Axis(id) => {
                expect_none(velocity)?;
                Ok(ik.task_mut(id)?.set_target(direction("target", target)?)?)
            }
            Self::Posture(id, _) => {
                expect_none(velocity)?;
                let q = vector_of("target", target, ik.model().position_count())?;
                Ok(with_slice(&q, |q| ik.task_mut(id)?.set_target(q))?)
            }
            Self::JointCoupling(id) => {
                expect_none(velocity)?;
                Ok(ik.task_mut(id)?.set_target(target.extract()?)?)
            }
            Self::Damping(_) => Err(Failure::value("a DampingTask has no target")),
            Self::Velocity(..) => {
                Err(Failure::value("a VelocityTask has rows and no target; set_rows writes them"))
            }
        }
    }

    /// Sets other weights of a task.
    pub(crate) fn weigh(self, ik: &mut Ik, weights: &Bound<'_, PyAny>) -> Result<()> {
        /// Gives a task other weights.
        macro_rules! weigh {
            ($id:expr, $weights:expr) => {{
                let weights = $weights;
                let task = ik.task_mut($id)?;
                *task = task.clone().with_weights(weights);
            }};
        }
        let joints = ik.model().velocity_count();
        match self {
            Self::Position(id) => weigh!(id, checked::<3>(weights)?.into()),
            Self::Orientation(id) => weigh!(id, checked::<3>(weights)?.into()),
            Self::CentreOfMass(id) => weigh!(id, checked::<3>(weights)?.into()),
            Self::Frame(id) => weigh!(id, checked::<6>(weights)?.into()),
            Self::RelativeFrame(id) => weigh!(id, checked::<6>(weights)?.into()),
            Self::Axis(id) => {
                let [weight] = checked::<1>(weights)?;
                let task = ik.task_mut(id)?;
                *task = task.clone().with_weight(weight);
            }
            Self::JointCoupling(id) => {
                let [weight] = checked::<1>(weights)?;
                let task = ik.task_mut(id)?;
                *task = task.clone().with_weight(weight);
            }
            Self::Posture(id, rows) => weigh!(id, &checked_list(weights, rows)?),
            Self::Damping(id) => weigh!(id, &checked_list(weights, joints)?),
            Self::Velocity(id, rows) => {
                for (row, weight) in checked_list(weights, rows)?.into_iter().enumerate() {
                    ik.task_mut(id)?.set_weight(row, weight)?;
                }
            }
        }
        Ok(())
    }

    /// Returns √(Σ wᵢ dᵢ²) of the task.
    pub(crate) fn slack(self, step: Step<'_>) -> Result<f64> {
        Ok(match self {
            Self::Position(id) => step.slack(id),
            Self::Orientation(id) => step.slack(id),
            Self::CentreOfMass(id) => step.slack(id),
            Self::Frame(id) => step.slack(id),
            Self::RelativeFrame(id) => step.slack(id),
            Self::Axis(id) => step.slack(id),
            Self::Posture(id, _) => step.slack(id),
            Self::Damping(id) => step.slack(id),
            Self::JointCoupling(id) => step.slack(id),
            Self::Velocity(id, _) => step.slack(id),
        }?)
    }
}

/// Writes rows lower ≤ A q̇ ≤ upper of a task or limit: all of them, (rows, n), (rows,) and (rows,).
pub(crate) fn write_rows(
    task: &mut VelocityTask,
    count: usize,
    [matrix, lower, upper]: [&Bound<'_, PyAny>; 3],
) -> Result<()> {
    let (matrix, lower, upper) = (
        Matrix::read("A", matrix)?.to_nalgebra(),
        vector_of("lower", lower, count)?,
        vector_of("upper", upper, count)?,
    );
    if matrix.nrows() != count {
        let found = matrix.nrows();
        return Err(Failure::value(format!("A has {found} rows; it must have {count}")));
    }
    let bounds = lower.as_array().to_vec().into_iter().zip(upper.as_array().to_vec());
    for ((row, coefficients), (lower, upper)) in matrix.row_iter().enumerate().zip(bounds) {
        task.set_row(row, coefficients.transpose().as_slice(), lower, upper)?;
    }
    Ok(())
}

/// Returns weights that are zero or positive, as many as the result has.
fn checked<const N: usize>(weights: &Bound<'_, PyAny>) -> Result<[f64; N]> {
    let weights = numbers::<N>("weights", weights)?;
    check_weights(&weights)?;
    Ok(weights)
}

fn checked_list(weights: &Bound<'_, PyAny>, count: usize) -> Result<Vec<f64>> {
    let weights = vector_of("weights", weights, count)?.as_array().to_vec();
    check_weights(&weights)?;
    Ok(weights)
}

fn check_weights(weights: &[f64]) -> Result<()> {
    let fits = |weight: &&f64| **weight == 0.0 || (1e-100..=1e100).contains(*weight);
    match weights.iter().find(|weight| !fits(weight)) {
        None => Ok(()),
        Some(value) => Err(Failure::value(format!(
            "a weight is {value}; it must be 0, which leaves a row out, or from 1e-100 to 1e100"
        ))),
    }
}

fn linear(velocity: Option<&Bound<'_, PyAny>>) -> Result<Vector3<f64>> {
    Ok(velocity.map_or(Ok([0.0; 3]), |velocity| numbers("velocity", velocity))?.into())
}

fn twist(velocity: Option<&Bound<'_, PyAny>>) -> Result<Vector6<f64>> {
    Ok(velocity.map_or(Ok([0.0; 6]), |velocity| numbers("velocity", velocity))?.into())
}

fn expect_none(velocity: Option<&Bound<'_, PyAny>>) -> Result<()> {
    match velocity {
        None => Ok(()),
        Some(_) => Err(Failure::value("the target of this task cannot move; leave velocity out")),
    }
}
