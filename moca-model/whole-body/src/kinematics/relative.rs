//! One frame seen from another.

use nalgebra::{Isometry3, Matrix6xX, Vector6};

use super::jacobian::turn_columns;
use crate::error::{Error, check_size};
use crate::robot::frame::FrameId;
use crate::spatial::Spatial;
use crate::state::moving::Moving;
use crate::state::posed::Posed;

impl Posed<'_> {
    /// Pose of `frame` in `reference`.
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

    /// The Jacobian of `frame` seen from `reference`, 6 × the size of q̇: the rate at which its
    /// origin and its axes move in the axes of the reference. Joints that carry both are zero.
    ///
    /// A joint between them moves the frame as in [`jacobian_into`](Self::jacobian_into); one below
    /// the reference moves it the other way.
    ///
    /// # Errors
    /// [`Error::ForeignId`]; [`Error::WrongSize`] unless `out` has as many columns as q̇ entries.
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

impl Moving<'_> {
    /// The twist of `frame` seen from `reference`, in the reference's axes: linear \[m/s\] then
    /// angular \[rad/s\].
    ///
    /// # Errors
    /// [`Error::ForeignId`].
    pub fn relative_twist(
        &self,
        reference: FrameId,
        frame: FrameId,
    ) -> Result<Vector6<f64>, Error> {
        let (axes, from) = self.motion_of(reference)?;
        let (pose, to) = self.motion_of(frame)?;
        let (from, to) = (from.velocity, to.velocity);
        let apart = pose.position - axes.position;
        let seen = Spatial {
            linear: to.linear - from.linear - from.angular.cross(&apart),
            angular: to.angular - from.angular,
        };
        Ok(seen.in_axes_of(&axes.rotation).to_vector())
    }

    /// J̇ q̇ of [`relative_jacobian_into`](Posed::relative_jacobian_into): linear \[m/s²\] then
    /// angular \[rad/s²\].
    ///
    /// The rates of Rᵀ(p − p₀) and of Rᵀ(ω − ω₀), R, p₀ and ω₀ being those of the reference
    /// (Siciliano et al. 2009, eq. 7.100, for the position).
    ///
    /// # Errors
    /// [`Error::ForeignId`].
    pub fn relative_jacobian_rate_times_velocity(
        &self,
        reference: FrameId,
        frame: FrameId,
    ) -> Result<Vector6<f64>, Error> {
        let (axes, from) = self.motion_of(reference)?;
        let (pose, to) = self.motion_of(frame)?;
        let apart = pose.position - axes.position;
        let turning = from.velocity.angular;
        let seen = to.velocity.linear - from.velocity.linear - turning.cross(&apart);
        let bias = Spatial {
            linear: to.bias.linear
                - from.bias.linear
                - from.bias.angular.cross(&apart)
                - turning.cross(&turning.cross(&apart))
                - 2.0 * turning.cross(&seen),
            angular: to.bias.angular - from.bias.angular - turning.cross(&to.velocity.angular),
        };
        Ok(bias.in_axes_of(&axes.rotation).to_vector())
    }
}
