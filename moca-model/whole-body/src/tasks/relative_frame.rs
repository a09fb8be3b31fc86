//! A frame at a pose of another frame.

use ahqp_core::{PoseAxes, pose_error};
use nalgebra::{Isometry3, Vector6};

use super::feedback::Feedback;
use super::frame_pose::{PoseFeedback, check_pose};
use super::input::TaskInput;
use super::rows::TaskRows;
use super::task::Task;
use crate::error::Error;
use crate::robot::frame::FrameId;
use crate::robot::model::Model;

/// Brings a frame to a pose in another frame of the robot: one hand to the other, a camera to a
/// hand. Up to six rows, in the reference's axes, linear \[m/s\] then angular \[rad/s\]:
/// J_rel q̇ = ẋ_d + feedback(x_d − x), J_rel being
/// [`Posed::relative_jacobian_into`](crate::Posed::relative_jacobian_into).
#[derive(Debug, Clone)]
pub struct RelativeFrameTask {
    reference: FrameId,
    frame: FrameId,
    target: Option<(Isometry3<f64>, Vector6<f64>)>,
    common: PoseFeedback,
}

impl RelativeFrameTask {
    /// Of `frame` in `reference`, in all coordinates; the target is to be set before the first step.
    pub fn new(reference: FrameId, frame: FrameId) -> Self {
        Self { reference, frame, target: None, common: PoseFeedback::default() }
    }

    /// With this gain \[1/s\] of position and orientation.
    #[must_use]
    pub fn with_gain(mut self, gain: f64) -> Self {
        self.common.set_gain(gain);
        self
    }

    /// With these feedbacks of position and orientation instead of [`Feedback::LINEAR`] and
    /// [`Feedback::ANGULAR`].
    #[must_use]
    pub fn with_feedback(mut self, linear: Feedback, angular: Feedback) -> Self {
        (self.common.linear, self.common.angular) = (linear, angular);
        self
    }

    /// These coordinates only, along the reference's axes.
    #[must_use]
    pub fn with_coordinates(mut self, coordinates: PoseAxes) -> Self {
        self.common.coordinates = coordinates;
        self
    }

    /// With weights of the six coordinates against the other rows of the level.
    #[must_use]
    pub fn with_weights(mut self, weights: Vector6<f64>) -> Self {
        self.common.weights = weights;
        self
    }

    /// The pose of the frame in the reference that is wanted.
    ///
    /// # Errors
    /// [`Error::NotFinite`]; the target is then as before.
    pub fn set_target(&mut self, pose: Isometry3<f64>) -> Result<(), Error> {
        self.set_moving_target(pose, Vector6::zeros())
    }

    /// The pose that is wanted, and the twist at which it moves, in the reference's axes.
    ///
    /// # Errors
    /// [`Error::NotFinite`]; the target is then as before.
    pub fn set_moving_target(
        &mut self,
        pose: Isometry3<f64>,
        twist: Vector6<f64>,
    ) -> Result<(), Error> {
        check_pose(&pose, &twist)?;
        self.target = Some((pose, twist));
        Ok(())
    }
}

impl Task for RelativeFrameTask {
    fn dimension(&self, _model: &Model) -> usize {
        self.common.coordinates.len()
    }

    fn validate(&self, model: &Model) -> Result<(), Error> {
        self.common.validate()?;
        model.expect_apart(self.reference, self.frame)
    }

    fn write(
        &mut self,
        input: &mut TaskInput<'_, '_>,
        rows: &mut TaskRows<'_>,
    ) -> Result<(), Error> {
        let (target, twist) = self.target.ok_or(Error::TargetMissing)?;
        let actual = input.posed().relative_pose(self.reference, self.frame)?;
        let error = pose_error(&target, &actual);
        let twist = twist + self.common.twist(&error, input.period())?;
        let jacobian = input.relative_jacobian(self.reference, self.frame)?;
        for (row, axis) in self.common.coordinates.iter().enumerate() {
            rows.set_coefficients(row, jacobian.row(axis).iter());
            rows.set_target(row, twist[axis]);
            rows.set_weight(row, self.common.weights[axis]);
        }
        Ok(())
    }
}
