//! Targets of tasks.

use nalgebra::{Point3, Vector3, Vector6};
use pyo3::prelude::*;
use whole_body::Ik;
use whole_body::ik::Step;
use whole_body::stack::TaskId;
use whole_body::tasks::{
    AxisTask, CentreOfMassTask, DampingTask, FrameTask, JointCouplingTask, OrientationTask,
    PositionTask, PostureTask, RelativeFrameTask,
};

use crate::arrays::{direction, numbers, orientation, pose, vector_of, with_slice};
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
    Posture(TaskId<PostureTask>),
    Damping(TaskId<DampingTask>),
    JointCoupling(TaskId<JointCouplingTask>),
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
            Self::Posture(id) => {
                expect_none(velocity)?;
                let q = vector_of("target", target, ik.model().position_count())?;
                Ok(with_slice(&q, |q| ik.task_mut(id)?.set_target(q))?)
            }
            Self::JointCoupling(id) => {
                expect_none(velocity)?;
                Ok(ik.task_mut(id)?.set_target(target.extract()?)?)
            }
            Self::Damping(_) => Err(Failure::value("a DampingTask has no target")),
        }
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
            Self::Posture(id) => step.slack(id),
            Self::Damping(id) => step.slack(id),
            Self::JointCoupling(id) => step.slack(id),
        }?)
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
