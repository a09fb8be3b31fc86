//! The task of moving a frame to a pose.

use ahqp_core::PoseAxes;
use nalgebra::{Isometry3, Vector3, Vector6};

use super::curvature::Curvature;
use super::input::TaskInput;
use super::pose_task::{PoseQuantity, PoseTask};
use super::rows::TaskRows;
use crate::error::Error;
use crate::kinematics::jacobian::Axes;
use crate::robot::frame::FrameId;
use crate::robot::model::Model;

/// Moves a frame to a pose of the world.
///
/// Position and orientation are on one level and weighed against each other if both cannot be met. A
/// [`PositionTask`](crate::tasks::PositionTask) above an [`OrientationTask`](crate::tasks::OrientationTask) gives the
/// position priority.
pub type FrameTask = PoseTask<FramePose>;

/// The pose of a frame in the world, with its Jacobian in these axes.
#[derive(Debug, Clone, Copy)]
pub struct FramePose {
    frame: FrameId,
    axes: Axes,
}

impl FrameTask {
    /// Creates the quantity for all coordinates of `frame`. Set the target before the first step.
    pub fn new(frame: FrameId) -> Self {
        Self::of(FramePose { frame, axes: Axes::World })
    }

    /// Restricts the task to these coordinates along `axes`: the world's, or the frame's own. The latter can leave the
    /// rotation about a tool's axis free, for example.
    #[must_use]
    pub fn with_coordinates(mut self, coordinates: PoseAxes, axes: Axes) -> Self {
        (self.coordinates, self.quantity.axes) = (coordinates, axes);
        self
    }
}

impl PoseQuantity for FramePose {
    fn validate(&self, model: &Model) -> Result<(), Error> {
        model.expect_moving(self.frame)
    }

    fn value(&self, input: &TaskInput<'_, '_>) -> Result<Isometry3<f64>, Error> {
        input.posed().world_from(self.frame)
    }

    fn turn(&self, actual: &Isometry3<f64>, vector: &mut Vector6<f64>) {
        if self.axes == Axes::Local {
            let turn = actual.rotation.inverse();
            for part in [0, 3] {
                let turned = turn * vector.fixed_rows::<3>(part).into_owned();
                vector.fixed_rows_mut::<3>(part).copy_from(&turned);
            }
        }
    }

    fn write_jacobian(
        &self,
        coordinates: PoseAxes,
        input: &mut TaskInput<'_, '_>,
        rows: &mut TaskRows<'_>,
    ) -> Result<(), Error> {
        let jacobian = input.jacobian(self.frame, self.axes)?;
        for (row, axis) in coordinates.iter().enumerate() {
            rows.set_jacobian_row(row, jacobian, axis);
        }
        Ok(())
    }

    const HAS_CURVATURE: bool = true;

    fn add_curvature(
        &self,
        [place, turn]: [&Vector3<f64>; 2],
        input: &mut TaskInput<'_, '_>,
        curvature: &mut Curvature,
    ) -> Result<(), Error> {
        let jacobian = input.jacobian(self.frame, self.axes)?;
        curvature.add_position(jacobian, place);
        curvature.add_orientation(jacobian, turn);
        Ok(())
    }
}
