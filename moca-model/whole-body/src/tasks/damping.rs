//! The task of resting.

use super::input::TaskInput;
use super::mask::check_weights;
use super::rows::TaskRows;
use super::task::Task;
use crate::error::{Error, check_size};
use crate::robot::model::Model;

/// Asks every entry of q̇ to be zero, one row each \[rad/s or m/s\]. As the last level it stops all motion that other
/// levels do not need.
#[derive(Debug, Clone, Default)]
pub struct DampingTask {
    weights: Vec<f64>,
}

impl DampingTask {
    /// Creates a task for all entries of q̇ with equal weights.
    pub fn new() -> Self {
        Self::default()
    }

    /// Sets weights of the entries of q̇ relative to each other.
    #[must_use]
    pub fn with_weights(mut self, weights: &[f64]) -> Self {
        self.weights = weights.to_vec();
        self
    }
}

impl Task for DampingTask {
    fn dimension(&self, model: &Model) -> usize {
        model.velocity_count()
    }

    fn validate(&self, model: &Model) -> Result<(), Error> {
        check_weights(&self.weights)?;
        if self.weights.is_empty() {
            return Ok(());
        }
        check_size("the list of weights", self.weights.len(), model.velocity_count())
    }

    fn is_damped(&self) -> bool {
        false
    }

    fn write(
        &mut self,
        _input: &mut TaskInput<'_, '_>,
        rows: &mut TaskRows<'_>,
    ) -> Result<(), Error> {
        for row in 0..rows.len() {
            if let Some(entry) = rows.row_mut(row).get_mut(row) {
                *entry = 1.0;
            }
            rows.set_weight(row, self.weights.get(row).copied().unwrap_or(1.0));
        }
        Ok(())
    }
}
