//! A frame's axes along given ones.

use ahqp_core::rotation_log;
use nalgebra::{UnitQuaternion, Vector3};

use super::feedback::Feedback;
use super::input::TaskInput;
use super::mask::{Axis, VectorMask};
use super::rows::TaskRows;
use super::task::Task;
use crate::error::{Error, check_finite};
use crate::kinematics::jacobian::Axes;
use crate::robot::frame::FrameId;
use crate::robot::model::Model;

/// Turns a frame to an orientation in the world: J_ω q̇ = ω_d + feedback(log(R_d Rᵀ)) (Siciliano et
/// al. 2009, Sec. 3.7.3, with the rotation vector as the error). Up to three rows, in world axes
/// \[rad/s\].
///
/// See [`PositionTask`](crate::PositionTask) for an example.
#[derive(Debug, Clone)]
pub struct OrientationTask {
    frame: FrameId,
    target: Option<(UnitQuaternion<f64>, Vector3<f64>)>,
    feedback: Feedback,
    mask: VectorMask,
}

impl OrientationTask {
    /// Of `frame`, about all axes; the target is to be set before the first step.
    pub fn new(frame: FrameId) -> Self {
        Self { frame, target: None, feedback: Feedback::ANGULAR, mask: VectorMask::default() }
    }

    /// With this gain \[1/s\] instead of that of [`Feedback::ANGULAR`].
    #[must_use]
    pub fn with_gain(mut self, gain: f64) -> Self {
        self.feedback.gain = gain;
        self
    }

    /// With this feedback instead of [`Feedback::ANGULAR`].
    #[must_use]
    pub fn with_feedback(mut self, feedback: Feedback) -> Self {
        self.feedback = feedback;
        self
    }

    /// About these axes of the world only.
    #[must_use]
    pub fn with_axes(mut self, axes: &[Axis]) -> Self {
        self.mask.choose(axes);
        self
    }

    /// With weights of the three axes against the other rows of the level.
    #[must_use]
    pub fn with_weights(mut self, weights: Vector3<f64>) -> Self {
        self.mask.weights = weights;
        self
    }

    /// The orientation of the frame in the world that is wanted.
    ///
    /// # Errors
    /// [`Error::NotFinite`]; the target is then as before.
    pub fn set_target(&mut self, orientation: UnitQuaternion<f64>) -> Result<(), Error> {
        self.set_moving_target(orientation, Vector3::zeros())
    }

    /// The orientation that is wanted, and the angular velocity at which it turns, in world axes
    /// \[rad/s\].
    ///
    /// # Errors
    /// [`Error::NotFinite`]; the target is then as before.
    pub fn set_moving_target(
        &mut self,
        orientation: UnitQuaternion<f64>,
        angular_velocity: Vector3<f64>,
    ) -> Result<(), Error> {
        for value in orientation.coords.iter().chain(&angular_velocity) {
            check_finite(*value, || "a number of the target".to_owned())?;
        }
        self.target = Some((orientation, angular_velocity));
        Ok(())
    }
}

impl Task for OrientationTask {
    fn dimension(&self, _model: &Model) -> usize {
        self.mask.len()
    }

    fn validate(&self, model: &Model) -> Result<(), Error> {
        self.feedback.validate()?;
        self.mask.validate()?;
        model.expect_moving(self.frame)
    }

    fn write(
        &mut self,
        input: &mut TaskInput<'_, '_>,
        rows: &mut TaskRows<'_>,
    ) -> Result<(), Error> {
        let (target, velocity) = self.target.ok_or(Error::TargetMissing)?;
        self.feedback.check_period(input.period())?;
        let actual = input.posed().world_from(self.frame)?.rotation;
        let error = self.mask.apply(&rotation_log(&(target * actual.inverse())));
        let velocity = velocity + self.feedback.velocity(&error);
        let jacobian = input.jacobian(self.frame, Axes::World)?;
        for (row, axis) in self.mask.iter().enumerate() {
            rows.set_coefficients(row, jacobian.row(3 + axis).iter());
            rows.set_target(row, velocity[axis]);
            rows.set_weight(row, self.mask.weights[axis]);
        }
        Ok(())
    }
}
