//! The task of moving a pose to a target.

use std::fmt::Debug;

use ahqp_core::{PoseAxes, pose_error};
use nalgebra::{Isometry3, Vector3, Vector6};

use super::curvature::Curvature;
use super::feedback::Feedback;
use super::input::TaskInput;
use super::mask::check_weights;
use super::rows::TaskRows;
use super::task::Task;
use crate::error::{Error, check_finite};
use crate::robot::model::Model;

/// A pose that joints change, either of a frame in the world or in another frame.
pub trait PoseQuantity: Clone + Debug + Send + Sync + 'static {
    /// Checks what can be checked without a state.
    ///
    /// # Errors
    /// The reason why this robot cannot control it.
    fn validate(&self, model: &Model) -> Result<(), Error>;

    /// The present pose.
    ///
    /// # Errors
    /// An id of another robot.
    fn value(&self, input: &TaskInput<'_, '_>) -> Result<Isometry3<f64>, Error>;

    /// Transforms a twist or an error from the axes of the pose to those of the rows.
    fn turn(&self, _actual: &Isometry3<f64>, _vector: &mut Vector6<f64>) {}

    /// Writes the rows of its Jacobian for the chosen coordinates, in their order.
    ///
    /// # Errors
    /// An id of another robot.
    fn write_jacobian(
        &self,
        coordinates: PoseAxes,
        input: &mut TaskInput<'_, '_>,
        rows: &mut TaskRows<'_>,
    ) -> Result<(), Error>;

    /// True if it adds its curvature; see [`Task::has_curvature`].
    const HAS_CURVATURE: bool = false;

    /// Adds its curvature to that of the level, for the residual to the target \[m, rad\].
    ///
    /// # Errors
    /// An id of another robot.
    fn add_curvature(
        &self,
        _missing: [&Vector3<f64>; 2],
        _input: &mut TaskInput<'_, '_>,
        _curvature: &mut Curvature,
    ) -> Result<(), Error> {
        Ok(())
    }
}

/// Moves a pose to a target: J q̇ = ẋ_d + feedback(x_d − x), where the error is [`pose_error`] (Siciliano et al. 2009,
/// Sec. 3.7). Up to six rows, linear \[m/s\], then angular \[rad/s\].
///
/// [`FrameTask`](crate::tasks::FrameTask) and [`RelativeFrameTask`](crate::tasks::RelativeFrameTask) are of this kind.
#[derive(Debug, Clone)]
pub struct PoseTask<Q: PoseQuantity> {
    pub(super) quantity: Q,
    target: Option<(Isometry3<f64>, Vector6<f64>)>,
    linear: Feedback,
    angular: Feedback,
    pub(super) coordinates: PoseAxes,
    weights: Vector6<f64>,
}

impl<Q: PoseQuantity> PoseTask<Q> {
    pub(super) fn of(quantity: Q) -> Self {
        Self {
            quantity,
            target: None,
            linear: Feedback::LINEAR,
            angular: Feedback::ANGULAR,
            coordinates: PoseAxes::ALL,
            weights: Vector6::repeat(1.0),
        }
    }

    /// Sets the gain of position and orientation \[1/s\].
    #[must_use]
    pub fn with_gain(mut self, gain: f64) -> Self {
        (self.linear.gain, self.angular.gain) = (gain, gain);
        self
    }

    /// Sets the feedbacks of position and orientation; the defaults are [`Feedback::LINEAR`] and [`Feedback::ANGULAR`].
    #[must_use]
    pub fn with_feedback(mut self, linear: Feedback, angular: Feedback) -> Self {
        (self.linear, self.angular) = (linear, angular);
        self
    }

    /// Sets the weights of the six coordinates relative to the other rows of the level.
    #[must_use]
    pub fn with_weights(mut self, weights: Vector6<f64>) -> Self {
        self.weights = weights;
        self
    }

    /// Sets the desired pose.
    ///
    /// # Errors
    /// [`Error::Value`]; the target is then unchanged.
    pub fn set_target(&mut self, pose: Isometry3<f64>) -> Result<(), Error> {
        self.set_moving_target(pose, Vector6::zeros())
    }

    /// Sets the desired pose and its twist, in the axes in which the pose is given.
    ///
    /// # Errors
    /// [`Error::Value`]; the target is then unchanged.
    pub fn set_moving_target(
        &mut self,
        pose: Isometry3<f64>,
        twist: Vector6<f64>,
    ) -> Result<(), Error> {
        let turn = pose.rotation.coords;
        for value in pose.translation.vector.iter().chain(turn.iter()).chain(&twist) {
            check_finite(*value, || "a number of the target".to_owned())?;
        }
        self.target = Some((pose, twist));
        Ok(())
    }

    /// The vector without the coordinates that are not chosen.
    fn chosen(&self, vector: &Vector6<f64>) -> Vector6<f64> {
        let mut chosen = Vector6::zeros();
        self.coordinates.iter().for_each(|axis| chosen[axis] = vector[axis]);
        chosen
    }

    /// The twist that reduces an error.
    fn twist(&self, chosen: &Vector6<f64>) -> Vector6<f64> {
        let linear = self.linear.velocity(&chosen.fixed_rows::<3>(0).into_owned());
        let angular = self.angular.velocity(&chosen.fixed_rows::<3>(3).into_owned());
        Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z)
    }
}

impl<Q: PoseQuantity> Task for PoseTask<Q> {
    fn dimension(&self, _model: &Model) -> usize {
        self.coordinates.len()
    }

    fn validate(&self, model: &Model) -> Result<(), Error> {
        self.linear.validate()?;
        self.angular.validate()?;
        check_weights(self.weights.as_slice())?;
        self.quantity.validate(model)
    }

    fn has_curvature(&self) -> bool {
        Q::HAS_CURVATURE
    }

    fn add_curvature(
        &self,
        factors: &[f64],
        input: &mut TaskInput<'_, '_>,
        curvature: &mut Curvature,
    ) -> Result<(), Error> {
        let mut all = Vector6::zeros();
        for (factor, axis) in factors.iter().zip(self.coordinates.iter()) {
            all[axis] = *factor;
        }
        let [place, turn] = [0, 3].map(|first| all.fixed_rows::<3>(first).into_owned());
        self.quantity.add_curvature([&place, &turn], input, curvature)?;
        Ok(())
    }

    fn hold(&mut self, input: &mut TaskInput<'_, '_>) -> Result<(), Error> {
        if self.target.is_none() {
            self.target = Some((self.quantity.value(input)?, Vector6::zeros()));
        }
        Ok(())
    }

    fn write(
        &mut self,
        input: &mut TaskInput<'_, '_>,
        rows: &mut TaskRows<'_>,
    ) -> Result<(), Error> {
        let (target, mut twist) = self.target.ok_or(Error::TargetMissing)?;
        self.linear.check_period(input.period())?;
        self.angular.check_period(input.period())?;
        let actual = self.quantity.value(input)?;
        let mut error = pose_error(&target, &actual);
        self.quantity.turn(&actual, &mut error);
        self.quantity.turn(&actual, &mut twist);
        twist = self.chosen(&twist) + self.twist(&self.chosen(&error));
        self.quantity.write_jacobian(self.coordinates, input, rows)?;
        for (row, axis) in self.coordinates.iter().enumerate() {
            rows.set_target(row, twist[axis]);
            rows.set_weight(row, self.weights[axis]);
        }
        Ok(())
    }
}
