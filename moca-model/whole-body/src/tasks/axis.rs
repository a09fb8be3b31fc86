//! The task of aligning an axis of a frame with a direction.

use nalgebra::{Unit, Vector2, Vector3};

use super::feedback::Feedback;
use super::input::TaskInput;
use super::mask::check_weights;
use super::rows::TaskRows;
use super::task::Task;
use crate::error::{Error, check_finite};
use crate::kinematics::jacobian::Axes;
use crate::robot::frame::FrameId;
use crate::robot::model::Model;

/// Aligns an axis of a frame with a direction of the world; the rotation about the axis is free. Examples are an
/// upright cup and a camera that looks at a place. Two rows \[rad/s\].
///
/// The rows are bᵢᵀ J_ω q̇ = bᵢᵀ feedback(φ (a × d)/‖a × d‖). Here a is the axis, d the direction and φ the angle
/// between them; b₁ and b₂ are two other axes that rotate with the frame.
#[derive(Debug, Clone)]
pub struct AxisTask {
    frame: FrameId,
    /// Axis in the frame.
    axis: Unit<Vector3<f64>>,
    across: [Vector3<f64>; 2],
    target: Option<Unit<Vector3<f64>>>,
    feedback: Feedback,
    weight: f64,
}

impl AxisTask {
    /// Creates a task for `axis`, a direction in `frame`. Set the target before the first step.
    pub fn new(frame: FrameId, axis: Unit<Vector3<f64>>) -> Self {
        // The coordinate axis least parallel to the axis gives the best cross product.
        let least = axis.iter().map(|part| part.abs()).enumerate();
        let least = least.min_by(|(_, one), (_, other)| one.total_cmp(other));
        let mut helper = Vector3::zeros();
        helper[least.map_or(0, |(index, _)| index)] = 1.0;
        let one = axis.cross(&helper).normalize();
        let across = [one, axis.cross(&one)];
        Self { frame, axis, across, target: None, feedback: Feedback::ANGULAR, weight: 1.0 }
    }

    /// Sets the gain \[1/s\]; the default is that of [`Feedback::ANGULAR`].
    #[must_use]
    pub fn with_gain(mut self, gain: f64) -> Self {
        self.feedback.gain = gain;
        self
    }

    /// Sets the feedback; the default is [`Feedback::ANGULAR`].
    #[must_use]
    pub fn with_feedback(mut self, feedback: Feedback) -> Self {
        self.feedback = feedback;
        self
    }

    /// Sets the weight relative to the other rows of the level.
    #[must_use]
    pub fn with_weight(mut self, weight: f64) -> Self {
        self.weight = weight;
        self
    }

    /// Sets the desired direction of the axis in the world.
    ///
    /// # Errors
    /// [`Error::Value`]; the target is then unchanged.
    pub fn set_target(&mut self, direction: Unit<Vector3<f64>>) -> Result<(), Error> {
        for value in direction.iter() {
            check_finite(*value, || "a coordinate of the direction".to_owned())?;
        }
        self.target = Some(direction);
        Ok(())
    }
}

impl Task for AxisTask {
    fn dimension(&self, _model: &Model) -> usize {
        2
    }

    fn validate(&self, model: &Model) -> Result<(), Error> {
        self.feedback.validate()?;
        check_weights(&[self.weight])?;
        for value in self.axis.iter() {
            check_finite(*value, || "a coordinate of the axis".to_owned())?;
        }
        model.expect_moving(self.frame)
    }

    fn hold(&mut self, input: &mut TaskInput<'_, '_>) -> Result<(), Error> {
        if self.target.is_none() {
            let rotation = input.posed().placement(self.frame)?.rotation;
            self.target = Some(rotation * self.axis);
        }
        Ok(())
    }

    fn write(
        &mut self,
        input: &mut TaskInput<'_, '_>,
        rows: &mut TaskRows<'_>,
    ) -> Result<(), Error> {
        let target = self.target.ok_or(Error::TargetMissing)?;
        self.feedback.check_period(input.period())?;
        let rotation = input.posed().placement(self.frame)?.rotation;
        let axis = rotation * self.axis.into_inner();
        let across = self.across.map(|direction| rotation * direction);
        let turn = axis.cross(&target);
        let (sine, cosine) = (turn.norm(), axis.dot(&target));
        let angle = sine.atan2(cosine);
        let error = if sine > 0.0 {
            Vector2::new(across[0].dot(&turn), across[1].dot(&turn)) * (angle / sine)
        } else {
            // In the opposite direction every rotation is equally short.
            Vector2::new(angle, 0.0)
        };
        let velocity = self.feedback.velocity(&error);
        let jacobian = input.jacobian(self.frame, Axes::World)?;
        for (row, direction) in across.iter().enumerate() {
            let own = rows.row_mut(row).iter_mut();
            for (entry, column) in own.zip(jacobian.column_iter()) {
                *entry = direction.dot(&column.fixed_rows::<3>(3));
            }
            rows.set_target(row, velocity[row]);
            rows.set_weight(row, self.weight);
        }
        Ok(())
    }
}
