//! The command of a step.

use hrsw_safety::{Cause, Fault, SafetyState};
use moca_model::{BaseMotion, Phase};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::arrays::{pose_to_array, to_vector};

type Vector<'py> = Bound<'py, PyArray1<f64>>;

/// The command of a step, and the state that led to it. n is the number of the robot's joints.
#[pyclass(frozen, module = "ahqp.collaboration")]
pub(crate) struct Command {
    pub(crate) told: moca_model::Command,
    pub(crate) torque: Option<Vec<f64>>,
    pub(crate) cause: Option<Cause>,
    pub(crate) waits_for: Option<Fault>,
    pub(crate) duration: f64,
}

#[pymethods]
impl Command {
    /// Velocities of all joints [m/s, rad/s], (n,).
    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> Vector<'py> {
        to_vector(py, &self.told.joint_velocity)
    }

    /// Positions of all joints [m, rad], (n,): the integral of the velocities, near the measured ones.
    #[getter]
    fn position<'py>(&self, py: Python<'py>) -> Vector<'py> {
        to_vector(py, &self.told.joint_position)
    }

    /// Torques [Nm], (n,), zero for joints that take velocities; None for a controller of velocities.
    #[getter]
    fn torque<'py>(&self, py: Python<'py>) -> Option<Vector<'py>> {
        self.torque.as_ref().map(|torque| to_vector(py, torque))
    }

    /// Velocity of a mecanum base in its own axes: forward, left [m/s], turn [rad/s]. Zero for other robots.
    #[getter]
    fn base_twist<'py>(&self, py: Python<'py>) -> Vector<'py> {
        to_vector(py, &self.told.base_twist)
    }

    /// True if the base drives. The arm alone holds the tool's place while it stands.
    #[getter]
    fn base_drives(&self) -> bool {
        matches!(self.told.base_motion, BaseMotion::Drives(_))
    }

    /// The desired pose of the hand at the tool, in the world, (4, 4).
    #[getter]
    fn desired<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        pose_to_array(py, &self.told.desired)
    }

    /// The velocity of the desired pose in the world's axes, linear, then angular, (6,) [m/s, rad/s].
    #[getter]
    fn desired_twist<'py>(&self, py: Python<'py>) -> Vector<'py> {
        to_vector(py, self.told.desired_twist.as_slice())
    }

    /// Distance of the desired pose outside the shared workspace, by coordinate, (6,) [m, rad].
    #[getter]
    fn slack<'py>(&self, py: Python<'py>) -> Vector<'py> {
        to_vector(py, self.told.slack.as_slice())
    }

    /// "apart", "looking", "handover", "grasping" (the gripper may close), "turning", "working" or "walking".
    #[getter]
    fn phase(&self) -> &'static str {
        match self.told.phase {
            Phase::Apart => "apart",
            Phase::Looking => "looking",
            Phase::Handover => "handover",
            Phase::Grasping => "grasping",
            Phase::Turning { .. } => "turning",
            Phase::Working => "working",
            Phase::Walking { .. } => "walking",
        }
    }

    /// True if the person works with the robot.
    #[getter]
    fn together(&self) -> bool {
        self.told.intention.is_together()
    }

    /// The share of ergonomics in the third level, 0 to 1.
    #[getter]
    fn activation(&self) -> f64 {
        self.told.activation
    }

    /// The safety state: "normal", "reduced", "retreat" or "protective_stop".
    #[getter]
    fn safety(&self) -> &'static str {
        match self.told.safety {
            SafetyState::Normal => "normal",
            SafetyState::Reduced => "reduced",
            SafetyState::Retreat => "retreat",
            SafetyState::ProtectiveStop => "protective_stop",
        }
    }

    /// Reason why the safety state is not normal: a fault, "person too close" or "nobody seen for too long".
    #[getter]
    fn cause(&self) -> Option<String> {
        self.cause.map(|cause| match cause {
            Cause::Fault(fault) => fault.to_string(),
            Cause::TooClose(_) => "person too close".to_owned(),
            Cause::Stale { .. } => "nobody seen for too long".to_owned(),
            _ => "another cause".to_owned(),
        })
    }

    /// The fault since the last step, if there was one: the one with the strictest safety state.
    #[getter]
    fn fault(&self) -> Option<String> {
        self.told.fault.map(|fault| fault.to_string())
    }

    /// The fault that waits for `Controller.acknowledge`. Until then the robot stands.
    #[getter]
    fn waits_for(&self) -> Option<String> {
        self.waits_for.map(|fault| fault.to_string())
    }

    /// True if every level is at its optimum. The robot is within its limits in any case.
    #[getter]
    fn is_optimal(&self) -> bool {
        self.told.outcome.is_optimal()
    }

    /// Time that the step took [s].
    #[getter]
    fn duration(&self) -> f64 {
        self.duration
    }

    fn __repr__(&self) -> String {
        format!("<ahqp.collaboration.Command: {}, {}>", self.phase(), self.safety())
    }
}
