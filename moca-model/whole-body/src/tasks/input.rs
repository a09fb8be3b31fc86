//! What a task sees of the robot.

use nalgebra::Matrix6xX;

use crate::error::Error;
use crate::kinematics::jacobian::Axes;
use crate::robot::frame::FrameId;
use crate::state::posed::Posed;

/// The robot as a task sees it: its configuration, what moves it, and room for Jacobians.
#[derive(Debug)]
pub struct TaskInput<'a, 'd> {
    posed: &'a mut Posed<'d>,
    velocity: &'a [f64],
    period: f64,
    jacobian: &'a mut JacobianMemory,
}

/// Room for one Jacobian, and which one it is.
#[derive(Debug, Clone)]
pub(crate) struct JacobianMemory {
    matrix: Matrix6xX<f64>,
    of: Option<(FrameId, Axes)>,
}

impl JacobianMemory {
    pub(crate) fn new(velocities: usize) -> Self {
        Self { matrix: Matrix6xX::zeros(velocities), of: None }
    }

    /// Forgets the Jacobian: the robot has moved.
    pub(crate) fn forget(&mut self) {
        self.of = None;
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

    /// The same, for what needs room to compute.
    pub fn posed_mut(&mut self) -> &mut Posed<'d> {
        self.posed
    }

    /// q̇ of the last step.
    pub fn velocity(&self) -> &[f64] {
        self.velocity
    }

    /// The time for which the velocity will hold \[s\].
    pub fn period(&self) -> f64 {
        self.period
    }

    /// The Jacobian of a frame, 6 × the size of q̇, linear then angular. Asked for again, or by
    /// another task, it is not computed again.
    ///
    /// # Errors
    /// [`Error::ForeignId`].
    pub fn jacobian(&mut self, frame: FrameId, axes: Axes) -> Result<&Matrix6xX<f64>, Error> {
        let memory = &mut *self.jacobian;
        if memory.of != Some((frame, axes)) {
            memory.of = None;
            self.posed.jacobian_into(frame, axes, &mut memory.matrix)?;
            memory.of = Some((frame, axes));
        }
        Ok(&memory.matrix)
    }

    /// The Jacobian of `frame` seen from `reference`, in the reference's axes.
    ///
    /// # Errors
    /// [`Error::ForeignId`].
    pub fn relative_jacobian(
        &mut self,
        reference: FrameId,
        frame: FrameId,
    ) -> Result<&Matrix6xX<f64>, Error> {
        self.jacobian.of = None;
        self.posed.relative_jacobian_into(reference, frame, &mut self.jacobian.matrix)?;
        Ok(&self.jacobian.matrix)
    }
}
