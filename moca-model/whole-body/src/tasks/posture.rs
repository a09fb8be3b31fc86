//! The task of moving the joints to a configuration.

use super::feedback::Feedback;
use super::input::TaskInput;
use super::mask::check_weights;
use super::rows::TaskRows;
use super::task::Task;
use crate::error::{Error, check_size};
use crate::robot::joint::{JointId, JointKind};
use crate::robot::model::Model;

/// Moves the joints to a configuration: q̇ᵢ = feedback(q_d,i − qᵢ), one row a joint \[rad/s or m/s\]. A floating base
/// has no row.
///
/// As the last level it decides motions that no other level determines. A redundant robot would otherwise drift.
#[derive(Debug, Clone)]
pub struct PostureTask {
    joints: Joints,
    target: Option<Vec<f64>>,
    feedback: Feedback,
    /// Gains of the joints in the order of the rows, or empty.
    gains: Vec<f64>,
    /// Weights of the joints in the order of the rows; missing ones are 1.
    weights: Vec<f64>,
}

#[derive(Debug, Clone)]
enum Joints {
    All,
    Some(Vec<JointId>),
}

impl PostureTask {
    /// Creates a task for all joints. Set the target before the first step.
    pub fn new() -> Self {
        let (gains, weights) = (Vec::new(), Vec::new());
        Self { joints: Joints::All, target: None, feedback: Feedback::JOINT, gains, weights }
    }

    /// Restricts the task to these joints.
    #[must_use]
    pub fn of_joints(mut self, joints: &[JointId]) -> Self {
        self.joints = Joints::Some(joints.to_vec());
        self
    }

    /// Sets the gain \[1/s\]; the default is that of [`Feedback::JOINT`].
    #[must_use]
    pub fn with_gain(mut self, gain: f64) -> Self {
        self.feedback.gain = gain;
        self
    }

    /// Sets the feedback; the default is [`Feedback::JOINT`].
    #[must_use]
    pub fn with_feedback(mut self, feedback: Feedback) -> Self {
        self.feedback = feedback;
        self
    }

    /// Sets a gain for each joint \[1/s\], in the order of the rows. A joint with a gain of zero only rests.
    #[must_use]
    pub fn with_gains(mut self, gains: &[f64]) -> Self {
        self.gains = gains.to_vec();
        self
    }

    /// Sets weights of the joints relative to each other, in the order of the rows.
    #[must_use]
    pub fn with_weights(mut self, weights: &[f64]) -> Self {
        self.weights = weights.to_vec();
        self
    }

    /// Sets the desired configuration, a whole q \[rad or m\]. Entries of other joints do not count. Allocates
    /// only the first time.
    ///
    /// # Errors
    /// [`Error::Value`]; the target is then unchanged.
    pub fn set_target(&mut self, configuration: &[f64]) -> Result<(), Error> {
        for value in configuration {
            crate::error::check_finite(*value, || "an entry of the posture".to_owned())?;
        }
        let target = self.target.get_or_insert_default();
        target.clear();
        target.extend_from_slice(configuration);
        Ok(())
    }

    /// The entries of q and q̇ of each row.
    fn entries<'a>(&'a self, model: &'a Model) -> impl Iterator<Item = (usize, usize)> + 'a {
        let (all, some) = match &self.joints {
            Joints::All => (model.joints(), &[][..]),
            Joints::Some(some) => (&[][..], some.as_slice()),
        };
        let some = some.iter().filter_map(|&id| model.joint(id).ok());
        let joints = all.iter().chain(some).filter(|joint| joint.kind != JointKind::Floating);
        joints.map(|joint| (joint.position_index, joint.velocity_index))
    }
}

impl Default for PostureTask {
    fn default() -> Self {
        Self::new()
    }
}

impl Task for PostureTask {
    fn dimension(&self, model: &Model) -> usize {
        self.entries(model).count()
    }

    fn validate(&self, model: &Model) -> Result<(), Error> {
        self.feedback.validate()?;
        check_weights(&self.weights)?;
        if let Joints::Some(joints) = &self.joints {
            for &joint in joints {
                model.expect_single(joint)?;
            }
        }
        if !self.weights.is_empty() {
            check_size("the list of weights", self.weights.len(), self.dimension(model))?;
        }
        if let Some(&value) = self.gains.iter().find(|gain| !(**gain >= 0.0 && gain.is_finite())) {
            let (what, expected) = ("a gain", "finite and not negative [1/s]");
            return Err(Error::value(what, value, expected));
        }
        if !self.gains.is_empty() {
            check_size("the list of gains", self.gains.len(), self.dimension(model))?;
        }
        Ok(())
    }

    fn is_damped(&self) -> bool {
        false
    }

    fn hold(&mut self, input: &mut TaskInput<'_, '_>) -> Result<(), Error> {
        if self.target.is_none() {
            self.target = Some(input.posed().configuration().to_vec());
        }
        Ok(())
    }

    fn write(
        &mut self,
        input: &mut TaskInput<'_, '_>,
        rows: &mut TaskRows<'_>,
    ) -> Result<(), Error> {
        let target = self.target.as_ref().ok_or(Error::TargetMissing)?;
        let period = input.period();
        self.feedback.check_period(period)?;
        let (model, q) = (input.posed().model(), input.posed().configuration());
        check_size("the posture", target.len(), q.len())?;
        for (row, (position, velocity)) in self.entries(model).enumerate() {
            if let Some(entry) = rows.row_mut(row).get_mut(velocity) {
                *entry = 1.0;
            }
            let mut feedback = self.feedback;
            if let Some(gain) = self.gains.get(row) {
                feedback.gain = *gain;
                feedback.check_period(period)?;
            }
            rows.set_target(row, feedback.speed(target[position] - q[position]));
            rows.set_weight(row, self.weights.get(row).copied().unwrap_or(1.0));
        }
        Ok(())
    }
}
