//! The task of moving a frame to a pose in another frame.

use ahqp_core::PoseAxes;
use nalgebra::Isometry3;

use super::input::TaskInput;
use super::pose_task::{PoseQuantity, PoseTask};
use super::rows::TaskRows;
use crate::error::Error;
use crate::robot::frame::FrameId;
use crate::robot::model::Model;

/// Moves a frame to a pose in another frame of the robot, such as one gripper to the other or a camera to a gripper.
/// All quantities are in the reference's axes; the Jacobian is
/// [`Posed::relative_jacobian_into`](crate::Posed::relative_jacobian_into).
pub type RelativeFrameTask = PoseTask<RelativePose>;

/// The pose of a frame in another one.
#[derive(Debug, Clone, Copy)]
pub struct RelativePose {
    reference: FrameId,
    frame: FrameId,
}

impl RelativeFrameTask {
    /// Creates the quantity for `frame` in `reference`, in all coordinates. Set the target before the first step.
    pub fn new(reference: FrameId, frame: FrameId) -> Self {
        Self::of(RelativePose { reference, frame })
    }

    /// Restricts the task to these coordinates, along the reference's axes.
    #[must_use]
    pub fn with_coordinates(mut self, coordinates: PoseAxes) -> Self {
        self.coordinates = coordinates;
        self
    }
}

impl PoseQuantity for RelativePose {
    fn validate(&self, model: &Model) -> Result<(), Error> {
        model.expect_apart(self.reference, self.frame)
    }

    fn value(&self, input: &TaskInput<'_, '_>) -> Result<Isometry3<f64>, Error> {
        input.posed().relative_pose(self.reference, self.frame)
    }

    fn write_jacobian(
        &self,
        coordinates: PoseAxes,
        input: &mut TaskInput<'_, '_>,
        rows: &mut TaskRows<'_>,
    ) -> Result<(), Error> {
        let jacobian = input.relative_jacobian(self.reference, self.frame)?;
        for (row, axis) in coordinates.iter().enumerate() {
            rows.set_jacobian_row(row, jacobian, axis);
        }
        Ok(())
    }
}
