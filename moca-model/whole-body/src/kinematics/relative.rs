//! Poses and Jacobians of one frame relative to another.

use nalgebra::{Isometry3, Matrix6xX};

use super::jacobian::turn_columns;
use crate::error::{Error, check_size};
use crate::robot::frame::FrameId;
use crate::state::posed::Posed;

impl Posed<'_> {
    /// The pose of `frame` in `reference` \[m\].
    ///
    /// # Errors
    /// [`Error::ForeignId`].
    pub fn relative_pose(
        &self,
        reference: FrameId,
        frame: FrameId,
    ) -> Result<Isometry3<f64>, Error> {
        let [reference, frame] = [self.model.frame(reference)?, self.model.frame(frame)?];
        let (reference, frame) = (self.pose_of(reference), self.pose_of(frame));
        let turned = reference.rotation.transpose();
        Ok(crate::spatial::Pose {
            rotation: turned * frame.rotation,
            position: turned * (frame.position - reference.position),
        }
        .to_isometry())
    }

    /// The Jacobian of `frame` relative to `reference`, 6 × the size of q̇. It maps q̇ to the rate of the frame's
    /// origin and axes in the axes of the reference. Columns of joints that move both frames alike are zero.
    ///
    /// A joint between them moves the frame as in [`jacobian_into`](Self::jacobian_into). A joint that only moves the
    /// reference has the opposite sign.
    ///
    /// # Errors
    /// [`Error::ForeignId`]; [`Error::Size`] unless `out` has as many columns as q̇ entries.
    pub fn relative_jacobian_into(
        &self,
        reference: FrameId,
        frame: FrameId,
        out: &mut Matrix6xX<f64>,
    ) -> Result<(), Error> {
        let [reference, frame] = [self.model.frame(reference)?, self.model.frame(frame)?];
        check_size("the Jacobian's list of columns", out.ncols(), self.model.velocities)?;
        let point = self.pose_of(frame).position;
        out.as_mut_slice().fill(0.0);
        self.add_columns(frame.body, &point, 1.0, out);
        self.add_columns(reference.body, &point, -1.0, out);
        turn_columns(&self.pose_of(reference).rotation, out);
        Ok(())
    }
}
