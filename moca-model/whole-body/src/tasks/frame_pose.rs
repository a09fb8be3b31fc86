//! A frame at a pose.

use ahqp_core::{PoseAxes, pose_error};
use nalgebra::{Isometry3, Vector6};

use super::feedback::Feedback;
use super::input::TaskInput;
use super::mask::check_weights;
use super::rows::TaskRows;
use super::task::Task;
use crate::error::{Error, check_finite};
use crate::kinematics::jacobian::Axes;
use crate::robot::frame::FrameId;
use crate::robot::model::Model;

/// Brings a frame to a pose of the world: J q̇ = ẋ_d + feedback(x_d − x), the error being
/// [`pose_error`] (Siciliano et al. 2009, Sec. 3.7). Up to six rows, linear \[m/s\] then angular
/// \[rad/s\].
///
/// In one level, position and orientation are weighed against each other where both cannot be met;
/// a [`PositionTask`](crate::PositionTask) above an [`OrientationTask`](crate::OrientationTask)
/// gives the position priority.
#[derive(Debug, Clone)]
pub struct FrameTask {
    frame: FrameId,
    target: Option<(Isometry3<f64>, Vector6<f64>)>,
    common: PoseFeedback,
}

/// What tasks of poses have in common.
#[derive(Debug, Clone, Copy)]
pub(super) struct PoseFeedback {
    pub(super) linear: Feedback,
    pub(super) angular: Feedback,
    pub(super) coordinates: PoseAxes,
    pub(super) axes: Axes,
    pub(super) weights: Vector6<f64>,
}

impl Default for PoseFeedback {
    fn default() -> Self {
        Self {
            linear: Feedback::LINEAR,
            angular: Feedback::ANGULAR,
            coordinates: PoseAxes::ALL,
            axes: Axes::World,
            weights: Vector6::repeat(1.0),
        }
    }
}

impl PoseFeedback {
    pub(super) fn set_gain(&mut self, gain: f64) {
        (self.linear.gain, self.angular.gain) = (gain, gain);
    }

    pub(super) fn validate(&self) -> Result<(), Error> {
        self.linear.validate()?;
        self.angular.validate()?;
        check_weights(self.weights.as_slice())
    }

    /// The twist that takes the chosen coordinates of an error away.
    pub(super) fn twist(&self, error: &Vector6<f64>, period: f64) -> Result<Vector6<f64>, Error> {
        self.linear.check_period(period)?;
        self.angular.check_period(period)?;
        let mut chosen = Vector6::zeros();
        self.coordinates.iter().for_each(|axis| chosen[axis] = error[axis]);
        let linear = self.linear.velocity(&chosen.fixed_rows::<3>(0).into_owned());
        let angular = self.angular.velocity(&chosen.fixed_rows::<3>(3).into_owned());
        Ok(Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z))
    }
}

impl FrameTask {
    /// Of `frame`, in all coordinates; the target is to be set before the first step.
    pub fn new(frame: FrameId) -> Self {
        Self { frame, target: None, common: PoseFeedback::default() }
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

    /// These coordinates only, counted along `axes`: the world's, or the frame's own (to leave the
    /// rotation about a tool's axis free, for example).
    #[must_use]
    pub fn with_coordinates(mut self, coordinates: PoseAxes, axes: Axes) -> Self {
        (self.common.coordinates, self.common.axes) = (coordinates, axes);
        self
    }

    /// With weights of the six coordinates against the other rows of the level.
    #[must_use]
    pub fn with_weights(mut self, weights: Vector6<f64>) -> Self {
        self.common.weights = weights;
        self
    }

    /// The pose of the frame in the world that is wanted.
    ///
    /// # Errors
    /// [`Error::NotFinite`]; the target is then as before.
    pub fn set_target(&mut self, pose: Isometry3<f64>) -> Result<(), Error> {
        self.set_moving_target(pose, Vector6::zeros())
    }

    /// The pose that is wanted, and the twist at which it moves, in world axes.
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

pub(super) fn check_pose(pose: &Isometry3<f64>, twist: &Vector6<f64>) -> Result<(), Error> {
    let numbers = pose.translation.vector.iter().chain(pose.rotation.coords.iter()).chain(twist);
    for value in numbers {
        check_finite(*value, || "a number of the target".to_owned())?;
    }
    Ok(())
}

impl Task for FrameTask {
    fn dimension(&self, _model: &Model) -> usize {
        self.common.coordinates.len()
    }

    fn validate(&self, model: &Model) -> Result<(), Error> {
        self.common.validate()?;
        model.expect_moving(self.frame)
    }

    fn write(
        &mut self,
        input: &mut TaskInput<'_, '_>,
        rows: &mut TaskRows<'_>,
    ) -> Result<(), Error> {
        let (target, mut twist) = self.target.ok_or(Error::TargetMissing)?;
        let PoseFeedback { coordinates, axes, weights, .. } = self.common;
        let actual = input.posed().world_from(self.frame)?;
        let mut error = pose_error(&target, &actual);
        if axes == Axes::Local {
            let turn = actual.rotation.inverse();
            for vector in [&mut error, &mut twist] {
                for part in [0, 3] {
                    let turned = turn * vector.fixed_rows::<3>(part).into_owned();
                    vector.fixed_rows_mut::<3>(part).copy_from(&turned);
                }
            }
        }
        twist += self.common.twist(&error, input.period())?;
        let jacobian = input.jacobian(self.frame, axes)?;
        for (row, axis) in coordinates.iter().enumerate() {
            rows.set_coefficients(row, jacobian.row(axis).iter());
            rows.set_target(row, twist[axis]);
            rows.set_weight(row, weights[axis]);
        }
        Ok(())
    }
}
