//! The task of moving a vector of the robot to a target.

use std::fmt::Debug;

use nalgebra::Vector3;

use super::curvature::Curvature;
use super::feedback::Feedback;
use super::input::TaskInput;
use super::mask::{Axis, VectorMask};
use super::rows::TaskRows;
use super::task::Task;
use crate::error::{Error, check_finite};
use crate::robot::model::Model;

/// A quantity with three coordinates in world axes that moves with the joints. It is a point, or an orientation whose
/// differences are rotation vectors.
pub trait VectorQuantity: Clone + Debug + Send + Sync + 'static {
    /// The type of its value.
    type Value: Copy + Debug + Send + Sync + 'static;
    /// The default feedback.
    const FEEDBACK: Feedback;

    /// Checks what does not depend on a state.
    ///
    /// # Errors
    /// The reason why this robot cannot control it.
    fn validate(&self, model: &Model) -> Result<(), Error>;

    /// The numbers of a value, for checks.
    fn numbers(value: &Self::Value) -> impl Iterator<Item = f64>;

    /// The present value.
    ///
    /// # Errors
    /// An id of another robot.
    fn value(&self, input: &TaskInput<'_, '_>) -> Result<Self::Value, Error>;

    /// The difference from `actual` to `target` \[m or rad\].
    fn difference(target: &Self::Value, actual: &Self::Value) -> Vector3<f64>;

    /// Writes the rows of its Jacobian along the chosen axes, in their order.
    ///
    /// # Errors
    /// An id of another robot.
    fn write_jacobian(
        &mut self,
        axes: impl Iterator<Item = usize>,
        input: &mut TaskInput<'_, '_>,
        rows: &mut TaskRows<'_>,
    ) -> Result<(), Error>;

    /// True if it adds its curvature; see [`Task::has_curvature`].
    const HAS_CURVATURE: bool = false;

    /// Adds its curvature to that of the level, for the residual to the target \[m or rad\].
    ///
    /// # Errors
    /// An id of another robot.
    fn add_curvature(
        &self,
        _missing: &Vector3<f64>,
        _input: &mut TaskInput<'_, '_>,
        _curvature: &mut Curvature,
    ) -> Result<(), Error> {
        Ok(())
    }
}

/// Moves a vector of the robot to a target: J q̇ = ẏ_d + feedback(y_d − y). Up to three rows, in world axes.
///
/// [`PositionTask`](crate::tasks::PositionTask), [`OrientationTask`](crate::tasks::OrientationTask) and
/// [`CentreOfMassTask`](crate::tasks::CentreOfMassTask) are of this kind.
#[derive(Debug, Clone)]
pub struct VectorTask<Q: VectorQuantity> {
    quantity: Q,
    target: Option<(Q::Value, Vector3<f64>)>,
    feedback: Feedback,
    mask: VectorMask,
}

impl<Q: VectorQuantity> VectorTask<Q> {
    /// Creates a task for this quantity along all axes. Set the target before the first step.
    pub fn of(quantity: Q) -> Self {
        let (feedback, mask) = (Q::FEEDBACK, VectorMask::default());
        Self { quantity, target: None, feedback, mask }
    }

    /// Sets the gain \[1/s\].
    #[must_use]
    pub fn with_gain(mut self, gain: f64) -> Self {
        self.feedback.gain = gain;
        self
    }

    /// Sets the feedback; the default is [`Feedback::LINEAR`] for lengths and [`Feedback::ANGULAR`] for angles.
    #[must_use]
    pub fn with_feedback(mut self, feedback: Feedback) -> Self {
        self.feedback = feedback;
        self
    }

    /// Restricts the task to these axes of the world.
    #[must_use]
    pub fn with_axes(mut self, axes: &[Axis]) -> Self {
        self.mask.choose(axes);
        self
    }

    /// Sets the weights of the three axes relative to the other rows of the level.
    #[must_use]
    pub fn with_weights(mut self, weights: Vector3<f64>) -> Self {
        self.mask.weights = weights;
        self
    }

    /// Sets the desired value in the world \[m\].
    ///
    /// # Errors
    /// [`Error::Value`]; the target is then unchanged.
    pub fn set_target(&mut self, target: impl Into<Q::Value>) -> Result<(), Error> {
        self.set_moving_target(target, Vector3::zeros())
    }

    /// Sets the desired value in the world and its velocity, linear \[m/s\] or angular \[rad/s\], in world axes.
    ///
    /// # Errors
    /// [`Error::Value`]; the target is then unchanged.
    pub fn set_moving_target(
        &mut self,
        target: impl Into<Q::Value>,
        velocity: Vector3<f64>,
    ) -> Result<(), Error> {
        let target = target.into();
        for value in Q::numbers(&target).chain(velocity.iter().copied()) {
            check_finite(value, || "a number of the target".to_owned())?;
        }
        self.target = Some((target, velocity));
        Ok(())
    }
}

impl<Q: VectorQuantity> Task for VectorTask<Q> {
    fn dimension(&self, _model: &Model) -> usize {
        self.mask.len()
    }

    fn validate(&self, model: &Model) -> Result<(), Error> {
        self.feedback.validate()?;
        self.mask.validate()?;
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
        let mut all = Vector3::zeros();
        for (factor, axis) in factors.iter().zip(self.mask.iter()) {
            all[axis] = *factor;
        }
        self.quantity.add_curvature(&all, input, curvature)?;
        Ok(())
    }

    fn hold(&mut self, input: &mut TaskInput<'_, '_>) -> Result<(), Error> {
        if self.target.is_none() {
            self.target = Some((self.quantity.value(input)?, Vector3::zeros()));
        }
        Ok(())
    }

    fn write(
        &mut self,
        input: &mut TaskInput<'_, '_>,
        rows: &mut TaskRows<'_>,
    ) -> Result<(), Error> {
        let (target, velocity) = self.target.ok_or(Error::TargetMissing)?;
        self.feedback.check_period(input.period())?;
        let actual = self.quantity.value(input)?;
        let error = self.mask.apply(&Q::difference(&target, &actual));
        let wanted = self.mask.apply(&velocity) + self.feedback.velocity(&error);
        self.quantity.write_jacobian(self.mask.iter(), input, rows)?;
        for (row, axis) in self.mask.iter().enumerate() {
            rows.set_target(row, wanted[axis]);
            rows.set_weight(row, self.mask.weights[axis]);
        }
        Ok(())
    }
}
