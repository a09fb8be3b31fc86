//! The input of a task.

use nalgebra::Matrix6xX;

use crate::error::Error;
use crate::kinematics::jacobian::Axes;
use crate::robot::frame::FrameId;
use crate::state::posed::Posed;

/// The input of a task: the robot's configuration and velocity, and memory for Jacobians.
#[derive(Debug)]
pub struct TaskInput<'a, 'd> {
    posed: &'a mut Posed<'d>,
    velocity: &'a [f64],
    period: f64,
    jacobian: &'a mut JacobianMemory,
}

/// The Jacobians that were computed last, each with its frame and axes.
#[derive(Debug, Clone)]
pub(crate) struct JacobianMemory {
    recent: [FrameJacobian; 4],
    /// Index of the oldest one.
    next: usize,
    relative: Matrix6xX<f64>,
}

#[derive(Debug, Clone)]
struct FrameJacobian {
    of: Option<(FrameId, Axes)>,
    matrix: Matrix6xX<f64>,
}

impl JacobianMemory {
    pub(crate) fn new(velocities: usize) -> Self {
        let none = || Matrix6xX::zeros(velocities);
        let recent = [(); 4].map(|()| FrameJacobian { of: None, matrix: none() });
        Self { recent, next: 0, relative: none() }
    }

    /// Forgets the Jacobians, after the robot has moved.
    pub(crate) fn forget(&mut self) {
        self.recent.iter_mut().for_each(|jacobian| jacobian.of = None);
    }
}

impl<'a, 'd> TaskInput<'a, 'd> {
    pub(crate) fn new(
        posed: &'a mut Posed<'d>,
        velocity: &'a [f64],
        period: f64,
        jacobian: &'a mut JacobianMemory,
    ) -> Self {
        Self { posed, velocity, period, jacobian }
    }

    /// The robot at its configuration.
    pub fn posed(&self) -> &Posed<'d> {
        self.posed
    }

    /// The robot at its configuration, for results that need scratch memory.
    pub fn posed_mut(&mut self) -> &mut Posed<'d> {
        self.posed
    }

    /// q̇ of the last step \[rad/s or m/s\].
    pub fn velocity(&self) -> &[f64] {
        self.velocity
    }

    /// The time for which the velocity will be applied \[s\].
    pub fn period(&self) -> f64 {
        self.period
    }

    /// The Jacobian of a frame, 6 × the size of q̇, linear, then angular. Further calls, also of other tasks, reuse it.
    ///
    /// # Errors
    /// [`Error::ForeignId`].
    pub fn jacobian(&mut self, frame: FrameId, axes: Axes) -> Result<&Matrix6xX<f64>, Error> {
        let JacobianMemory { recent, next, .. } = &mut *self.jacobian;
        let known = recent.iter().position(|jacobian| jacobian.of == Some((frame, axes)));
        let index = known.unwrap_or(*next);
        let FrameJacobian { of, matrix } = &mut recent[index];
        if known.is_none() {
            *of = None;
            self.posed.jacobian_into(frame, axes, matrix)?;
            *of = Some((frame, axes));
            *next = (index + 1) % 4;
        }
        Ok(matrix)
    }

    /// The Jacobian of `frame` relative to `reference`, in the reference's axes.
    ///
    /// # Errors
    /// [`Error::ForeignId`].
    pub fn relative_jacobian(
        &mut self,
        reference: FrameId,
        frame: FrameId,
    ) -> Result<&Matrix6xX<f64>, Error> {
        self.posed.relative_jacobian_into(reference, frame, &mut self.jacobian.relative)?;
        Ok(&self.jacobian.relative)
    }
}
