//! Poses of frames in the world.

use nalgebra::{Isometry3, IsometryMatrix3};

use crate::error::{Error, check_size};
use crate::robot::frame::{Frame, FrameId};
use crate::spatial::Pose;
use crate::state::posed::Posed;

impl Posed<'_> {
    /// The pose of a frame in the world \[m\].
    ///
    /// # Errors
    /// [`Error::ForeignId`].
    pub fn world_from(&self, frame: FrameId) -> Result<Isometry3<f64>, Error> {
        Ok(self.pose_of(self.model.frame(frame)?).to_isometry())
    }

    /// The pose of a frame in the world with a rotation matrix, as the robot stores it. No quaternion is computed.
    ///
    /// # Errors
    /// [`Error::ForeignId`].
    pub fn placement(&self, frame: FrameId) -> Result<IsometryMatrix3<f64>, Error> {
        Ok(self.pose_of(self.model.frame(frame)?).to_isometry_matrix())
    }

    /// Writes the poses of all frames in the world \[m\], in the order of [`Model::frames`](crate::Model::frames).
    ///
    /// # Errors
    /// [`Error::Size`] unless `out` has one element for each frame.
    pub fn placements_into(&self, out: &mut [IsometryMatrix3<f64>]) -> Result<(), Error> {
        check_size("the list of placements", out.len(), self.model.frames.len())?;
        for (out, frame) in out.iter_mut().zip(&self.model.frames) {
            *out = self.pose_of(frame).to_isometry_matrix();
        }
        Ok(())
    }

    #[inline]
    pub(super) fn pose_of(&self, frame: &Frame) -> Pose {
        self.data.poses[frame.body].then(&frame.pose)
    }
}
