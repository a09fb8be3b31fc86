//! The task of a linear relation between joints.

use super::feedback::Feedback;
use super::input::TaskInput;
use super::mask::check_weights;
use super::rows::TaskRows;
use super::task::Task;
use crate::error::{Error, check_finite};
use crate::robot::joint::JointId;
use crate::robot::model::Model;

/// Keeps Σ cᵢ qᵢ at a value, for example for two fingers that move together or a lift of two halves. One row \[rad/s or
/// m/s\]: Σ cᵢ q̇ᵢ = feedback(value − Σ cᵢ qᵢ).
#[derive(Debug, Clone)]
pub struct JointCouplingTask {
    joints: Vec<(JointId, f64)>,
    value: f64,
    feedback: Feedback,
    weight: f64,
}

impl JointCouplingTask {
    /// Creates a task for these joints and their coefficients cᵢ, with the value zero.
    pub fn new(joints: &[(JointId, f64)]) -> Self {
        let feedback = Feedback { gain: 20.0, ..Feedback::ANGULAR };
        Self { joints: joints.to_vec(), value: 0.0, feedback, weight: 1.0 }
    }

    /// Sets the feedback; the default is 20 1/s and 5 rad/s².
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

    /// Sets the desired value of Σ cᵢ qᵢ.
    ///
    /// # Errors
    /// [`Error::Value`]; the target is then unchanged.
    pub fn set_target(&mut self, value: f64) -> Result<(), Error> {
        check_finite(value, || "the value of the coupling".to_owned())?;
        self.value = value;
        Ok(())
    }
}

impl Task for JointCouplingTask {
    fn dimension(&self, _model: &Model) -> usize {
        1
    }

    fn validate(&self, model: &Model) -> Result<(), Error> {
        self.feedback.validate()?;
        check_weights(&[self.weight])?;
        for &(joint, coefficient) in &self.joints {
            model.expect_single(joint)?;
            check_finite(coefficient, || "a coefficient of the coupling".to_owned())?;
        }
        if self.joints.iter().any(|&(_, coefficient)| coefficient != 0.0) {
            return Ok(());
        }
        let (what, expected) = ("the sum of the coefficients' magnitudes", "positive");
        Err(Error::value(what, 0.0, expected))
    }

    fn is_damped(&self) -> bool {
        false
    }

    fn write(
        &mut self,
        input: &mut TaskInput<'_, '_>,
        rows: &mut TaskRows<'_>,
    ) -> Result<(), Error> {
        self.feedback.check_period(input.period())?;
        let mut error = self.value;
        for &(id, coefficient) in &self.joints {
            let joint = input.posed().model().joint(id)?;
            error -= coefficient * input.posed().configuration()[joint.position_index];
            if let Some(entry) = rows.row_mut(0).get_mut(joint.velocity_index) {
                *entry += coefficient;
            }
        }
        rows.set_target(0, self.feedback.speed(error));
        rows.set_weight(0, self.weight);
        Ok(())
    }
}
