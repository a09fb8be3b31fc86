//! Velocity limits of a frame.

use nalgebra::{Vector3, Vector6};

use crate::error::Error;
use crate::kinematics::jacobian::Axes;
use crate::robot::frame::FrameId;
use crate::robot::model::Model;
use crate::tasks::input::TaskInput;
use crate::tasks::rows::TaskRows;
use crate::tasks::task::{Limit, Task};

/// Limits the velocity of a frame along and about each of three axes: |Jᵢ q̇| ≤ limitᵢ.
///
/// A limit s on the speed in any direction is met by s/√3 along each axis.
///
/// Axes rotate as the robot moves, and joints need time to change their accelerations. Therefore 5 % of the limit are
/// kept in reserve. Fast joints may cancel each other at the frame. They stay slow enough that all can stop evenly
/// while the axes rotate and before one of them reaches its position limit.
#[derive(Debug, Clone)]
pub struct FrameVelocityLimit {
    frame: FrameId,
    axes: Axes,
    limits: Vector6<f64>,
}

impl FrameVelocityLimit {
    /// Creates the limit for `frame` along the world's axes \[m/s\] and about them \[rad/s\]; infinity means no limit.
    pub fn new(frame: FrameId, linear: Vector3<f64>, angular: Vector3<f64>) -> Self {
        let limits = Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z);
        Self { frame, axes: Axes::World, limits }
    }

    /// Applies the limits along and about the frame's own axes.
    #[must_use]
    pub fn in_local_axes(mut self) -> Self {
        self.axes = Axes::Local;
        self
    }

    fn limited(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.limits.iter().copied().enumerate().filter(|(_, limit)| limit.is_finite())
    }
}

/// Share of a limit that tasks may use.
const USED: f64 = 0.95;

fn check(limits: &Vector6<f64>) -> Result<(), Error> {
    match limits.iter().find(|limit| limit.is_nan() || **limit <= 0.0) {
        None => Ok(()),
        Some(&value) => {
            let (what, expected) = ("a limit of the frame", "positive, or infinite for none");
            Err(Error::value(what, value, expected))
        }
    }
}

impl Task for FrameVelocityLimit {
    fn dimension(&self, _model: &Model) -> usize {
        self.limited().count()
    }

    fn validate(&self, model: &Model) -> Result<(), Error> {
        check(&self.limits)?;
        model.expect_moving(self.frame)
    }

    fn is_damped(&self) -> bool {
        false
    }

    fn write(
        &mut self,
        input: &mut TaskInput<'_, '_>,
        rows: &mut TaskRows<'_>,
    ) -> Result<(), Error> {
        let jacobian = input.jacobian(self.frame, self.axes)?;
        for (row, (axis, limit)) in self.limited().enumerate() {
            rows.set_jacobian_row(row, jacobian, axis);
            rows.set_range(row, -USED * limit, USED * limit);
        }
        Ok(())
    }
}

impl Limit for FrameVelocityLimit {}
