//! Twists of frames and the accelerations that velocity alone causes.

use nalgebra::Vector6;

use super::jacobian::Axes;
use crate::error::Error;
use crate::robot::frame::FrameId;
use crate::spatial::{Pose, Spatial};
use crate::state::data::BodyMotion;
use crate::state::moving::{Moving, carried};

impl Moving<'_> {
    /// The twist of a frame at its origin, J q̇: linear \[m/s\] then angular \[rad/s\].
    ///
    /// # Errors
    /// [`Error::ForeignId`].
    pub fn twist(&self, frame: FrameId, axes: Axes) -> Result<Vector6<f64>, Error> {
        let (pose, motion) = self.motion_of(frame)?;
        Ok(match axes {
            Axes::World => motion.velocity,
            Axes::Local => motion.velocity.in_axes_of(&pose.rotation),
        }
        .to_vector())
    }

    /// J̇ q̇, so that J q̈ + J̇ q̇ is the rate of [`twist`](Self::twist) in the same axes: linear \[m/s²\], then
    /// angular \[rad/s²\].
    ///
    /// In local axes it does not contain ω × v, by which rotating axes change the components of the velocity.
    ///
    /// # Errors
    /// [`Error::ForeignId`].
    pub fn jacobian_rate_times_velocity(
        &self,
        frame: FrameId,
        axes: Axes,
    ) -> Result<Vector6<f64>, Error> {
        let (pose, BodyMotion { velocity, bias }) = self.motion_of(frame)?;
        Ok(match axes {
            Axes::World => bias,
            Axes::Local => {
                let turning = velocity.angular.cross(&velocity.linear);
                let seen = Spatial { linear: bias.linear - turning, angular: bias.angular };
                seen.in_axes_of(&pose.rotation)
            }
        }
        .to_vector())
    }

    pub(super) fn motion_of(&self, frame: FrameId) -> Result<(Pose, BodyMotion), Error> {
        let found = self.posed.model.frame(frame)?;
        let pose = self.posed.pose_of(found);
        let apart = pose.position - self.posed.data.poses[found.body].position;
        Ok((pose, carried(&self.posed.data.motions[found.body], &apart)))
    }
}
